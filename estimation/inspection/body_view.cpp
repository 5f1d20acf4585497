#include "estimation/inspection/body_view.h"

#include <algorithm>

namespace hookeye::inspection {

BodyView::BodyView(const Scene& scene)
    : renderer_(scene.body->surface.mesh), smooth_(!scene.capture.body.flat_shading) {}

BodyPicture BodyView::look(const Camera& camera, const Matrix3Xd& x, const Paint& paint,
                           const Matrix3Xd* x_reference) {
  RenderOptions options;
  options.rays_per_axis = 2;
  options.filter_width_px = 2.0;
  options.smooth_normals = smooth_;
  options.visibility_rays = paint.shaded ? 16 : 0;
  options.derivatives = false;
  PhotoState state;
  state.camera = camera;
  state.shaded = paint.shaded;
  state.ambient = paint.ambient;
  state.uneven = paint.uneven;
  state.sun = paint.sun;
  const bool from_photo = paint.texture.source == Texture::Source::photo;
  Rendering rendering = renderer_.render(x, from_photo ? (x_reference ? x_reference : &x) : nullptr,
                                         paint.texture, state, options, true);
  BodyPicture out;
  out.I = std::move(rendering.I);
  out.triangle = std::move(rendering.triangle);
  out.uv = std::move(rendering.uv);
  for (const float covered : rendering.coverage.values) {
    out.body.push_back(covered > 0.999f);
    out.outline_of.push_back(covered >= 0.5f);
  }
  return out;
}

std::optional<Paint> told_paint(const Scene& scene, const PhotoState& state, int plane, int level) {
  if (scene.capture.body.texture != BodySpec::Texture::image) return {};
  Paint paint;
  const auto& sizes = scene.albedo[std::min(scene.albedo.size() - 1, static_cast<size_t>(plane))];
  paint.texture.source = Texture::Source::image;
  // Rays of a twice halved photo are two of its pixels apart.
  paint.texture.image = sizes[std::min<size_t>(level >= 2 ? 1 : 0, sizes.size() - 1)];
  if (!scene.capture.light.given) return paint;
  paint.shaded = true;
  paint.ambient = state.ambient;
  paint.uneven = state.uneven;
  paint.sun = state.sun;
  return paint;
}

Vector2d place_of(const Camera& camera, const SurfaceMesh& surface, const Matrix3Xd& x,
                  int triangle, const Eigen::Vector2f& uv) {
  const auto& t = surface.triangles[static_cast<size_t>(triangle)];
  const double u = uv.x(), v = uv.y();
  return camera.project((1.0 - u - v) * x.col(t[0]) + u * x.col(t[1]) + v * x.col(t[2]));
}

}  // namespace hookeye::inspection
