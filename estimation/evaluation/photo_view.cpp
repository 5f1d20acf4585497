#include "estimation/evaluation/photo_view.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace hookeye {

RenderOptions render_options(const Scene& scene) {
  RenderOptions options;
  options.smooth_normals = !scene.capture.body.flat_shading;
  return options;
}

namespace {

/// The mean of four pixels has half their noise, and shows the more what rays see of a rim: off by
/// 1/n^1.5 of a pixel where n are along an axis.
constexpr int kRaysOfHalved = 4;

}  // namespace

RenderOptions at_level(RenderOptions options, int level, int halvings, const Texture& texture,
                       int rays_per_axis) {
  if (level == 0 && texture.source == Texture::Source::photo)
    options.rays_per_axis = 1, options.filter_width_px = 1.0;
  else if (level == 0 && halvings > 0)
    options.halvings = halvings, options.rays_per_axis = kRaysOfHalved;
  if (level == 0 && rays_per_axis > 0)
    options.rays_per_axis = std::min(rays_per_axis, options.rays_per_axis);
  if (level == 0) return options;
  options.rays_per_axis = std::min(1 + 3 * level, 15);
  options.filter_width_px = 2.4;
  return options;
}

PhotoState state_at_level(const PhotoState& state, int level) {
  PhotoState coarse = state;
  coarse.camera = camera_at_level(state.camera, level);
  coarse.blur_variance *= std::pow(0.25, level);
  return coarse;
}

bool by_colour(const Scene& scene, int example, int photo) {
  return scene.capture.examples[example].photos[photo].rgb &&
         scene.photos[example][photo].planes.size() == 3;
}

Camera camera_of_plane(const Scene& scene, int example, int photo, int plane,
                       const Camera& camera) {
  return by_colour(scene, example, photo) ? camera.of_colour(plane) : camera;
}

bool is_silhouette(const Scene& scene, int example, int photo) {
  return scene.capture.examples[example].photos[photo].kind == PhotoSpec::Kind::silhouette;
}

int reference_photo(const Scene& scene, int reference, const std::string& camera) {
  const auto& photos = scene.capture.examples[reference].photos;
  for (size_t k = 0; k < photos.size(); ++k)
    if (photos[k].camera == camera) return static_cast<int>(k);
  return -1;
}

namespace {

/// Side of a texel in px of the photo as it was taken, in the middle of what the camera may see of
/// the body at rest.
double texel_px(const Scene& scene, const std::string& name, const Image& texture) {
  const SurfaceMesh& surface = scene.body->surface.mesh;
  const Camera& camera = scene.capture.camera(name);
  std::vector<double> sides;
  for (size_t t = 0; t < surface.uv.size() && t < surface.triangles.size(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    const Eigen::Vector2d A = camera.project(surface.X.col(a)),
                          B = camera.project(surface.X.col(b)),
                          C = camera.project(surface.X.col(c));
    const auto area = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
      return std::abs(p.x() * q.y() - p.y() * q.x());
    };
    const auto& uv = surface.uv[t];
    const double texels = area(uv[1] - uv[0], uv[2] - uv[0]) * double(texture.pixels());
    const double pixels = area(B - A, C - A);
    if (texels > 0.0 && std::isfinite(pixels)) sides.push_back(std::sqrt(pixels / texels));
  }
  if (sides.empty()) return 1.0;
  const auto middle = sides.begin() + static_cast<std::ptrdiff_t>(sides.size() / 2);
  std::nth_element(sides.begin(), middle, sides.end());
  return std::max(*middle, 1e-3) * std::exp2(scene.halvings_of(name));
}

/// Of a texture that rays meet every `apart` texels: none is passed over, and none blurred.
size_t texture_halvings(double apart) { return apart > 2.8 ? 2 : apart > 1.4 ? 1 : 0; }

}  // namespace

bool choose_texture(const Scene& scene, const Model& model, int example, int photo, int plane,
                    PhotoSize size, Texture& texture) {
  const BodySpec& body = scene.capture.body;
  if (is_silhouette(scene, example, photo) || body.texture == BodySpec::Texture::uniform ||
      body.texture == BodySpec::Texture::none)
    return true;
  if (body.texture == BodySpec::Texture::image) {
    texture.source = Texture::Source::image;
    const bool by_channel = scene.capture.examples[example].photos[photo].rgb;
    const auto& sizes = scene.albedo[by_channel && scene.albedo.size() > 1 ? plane : 0];
    // Texels as large as the rays are apart, in pixels of the photo as it was taken.
    const std::string& camera = scene.capture.examples[example].photos[photo].camera;
    const int halvings = size.as_taken ? 0 : scene.halvings_of(camera), level = size.level;
    const int rays = level > 0                ? std::min(1 + 3 * level, 15)
                     : size.rays_per_axis > 0 ? size.rays_per_axis
                     : halvings > 0           ? kRaysOfHalved
                                              : RenderOptions{}.rays_per_axis;
    const double apart = std::exp2(level + halvings) / rays;
    size_t smaller = apart > 1.4 ? 2 : apart > 0.7 ? 1 : 0;
    // Large photos may show a texel in several pixels: a coarser one would be blurred.
    if (halvings > 0) smaller = texture_halvings(apart / texel_px(scene, camera, *sizes[0]));
    texture.image = sizes[std::min(smaller, sizes.size() - 1)];
    return true;
  }
  const int reference = scene.example_index(body.texture_example);
  const int k =
      reference_photo(scene, reference, scene.capture.examples[example].photos[photo].camera);
  if (k < 0 || reference == example) return false;
  const Photo& source = scene.photos[reference][k];
  texture.source = Texture::Source::photo;
  texture.photo = source.planes[plane].pointer();
  texture.photo_valid = source.valid.pointer();
  texture.reference_camera =
      camera_of_plane(scene, reference, k, plane, model.examples[reference].photos[k].camera);
  texture.reference_gain = model.examples[reference].photos[k].gain;
  return true;
}

PhotoState coverage_state(PhotoState state) {
  state.gain = 1.0;
  state.camera.vignetting = 0.0;
  state.shaded = false;
  state.sun.setZero();
  state.specular = 0.0;
  state.background = 0.0;
  state.backdrop = nullptr;
  return state;
}

namespace {

VertexSensitivity vertex_sensitivity(const Renderer& renderer, const RenderSurface& surface,
                                     const Matrix3Xd& x, const Eigen::MatrixXd& S,
                                     const Eigen::MatrixXd* S_reference, bool normals) {
  const auto on_vertices = [&](const RowMatrix& nodal) {
    RowMatrix out = RowMatrix::Zero(3 * surface.W.rows(), nodal.cols());
    for (int v = 0; v < surface.W.outerSize(); ++v)
      for (decltype(surface.W)::InnerIterator w(surface.W, v); w; ++w)
        out.middleRows<3>(3 * w.row()) += w.value() * nodal.middleRows<3>(3 * w.col());
    return out;
  };
  VertexSensitivity out;
  out.position = on_vertices(S);
  if (normals) out.second = renderer.normal_derivative(x) * out.position;
  if (S_reference) out.second = on_vertices(*S_reference);
  return out;
}

/// The texture is looked up with the reference photo's camera and divided by its gain, and a
/// parameter may change those as well (a set-up placed elsewhere, a focal length). The camera's
/// motion x_c' = exp([w]x) x_c + v is the opposite of one of the reference points, and so is a
/// zoom.
void add_reference_photo(const Camera& camera, const Matrix3Xd& x_reference,
                         const Eigen::MatrixXd& by_reference_photo, VertexSensitivity* S) {
  const auto& d = by_reference_photo;
  if (d.topRows(kLogGain + 1).isZero(0.0)) return;
  S->photo.row(kLogGain) -= d.row(kLogGain);
  Camera local = camera;
  local.R.setIdentity();
  local.t.setZero();
  for (int v = 0; v < x_reference.cols(); ++v) {
    const Vector3d p = camera.R * x_reference.col(v) + camera.t;
    Camera::Jacobian3 by_point;
    Camera::Jacobian7 by_camera;
    local.project(p, &by_point, &by_camera);
    Vector3d zoom = Vector3d::Zero();
    zoom.head<2>() = by_point.leftCols<2>().inverse() * by_camera.col(6);
    for (int j = 0; j < d.cols(); ++j)
      S->second.block<3, 1>(3 * v, j) +=
          camera.R.transpose() *
          (d.block<3, 1>(kRotate, j).cross(p) + d.block<3, 1>(kMove, j) + d(kZoom, j) * zoom);
  }
}

}  // namespace

ExampleView::ExampleView(const Scene& scene, Renderer& renderer, const Model& model,
                         const ExampleEvaluation& example, const ReferenceState& reference,
                         const ExampleColumns* columns)
    : scene_(scene),
      renderer_(renderer),
      model_(model),
      reference_(reference),
      columns_(columns),
      example_(example.example) {
  const RenderSurface& surface = scene.body->surface;
  x_ = surface.deformed(scene.body->mesh, example.equilibrium->q);
  if (reference.state)
    x_reference_ = surface.deformed(scene.body->mesh, reference.state->equilibrium->q);
  if (!columns) return;
  const bool has_light = scene.capture.body.texture != BodySpec::Texture::rest;
  S_ = vertex_sensitivity(renderer, surface, x_, example.S,
                          reference.state ? &reference.state->S : nullptr, has_light);
  second_on_vertices_ = S_.second;
}

bool ExampleView::shows_rim(int photo) const {
  return is_mask(photo) || scene_.capture.examples[example_].photos[photo].background.kind !=
                               BackgroundSpec::Kind::ignore;
}

RenderOptions ExampleView::rendering(int photo, const Texture& texture, PhotoSize size,
                                     const EvaluationOptions& options) const {
  const std::string& camera = model_.examples[example_].photos[photo].camera.name;
  RenderOptions out =
      at_level(render_options(scene_), size.level, size.as_taken ? 0 : scene_.halvings_of(camera),
               texture, options.rays_per_axis);
  out.derivatives = derivatives();
  out.parallel = true;
  out.centres = options.pictures || texture.source == Texture::Source::photo;
  const auto moves = [&](PhotoColumn column, int count = 1) {
    return columns_ && !columns_->dphoto[photo].middleRows(column, count).isZero(0.0);
  };
  // The texture is divided by the gain of the photo that it is from.
  const bool texture_gain =
      columns_ && reference_.columns && texture.source == Texture::Source::photo &&
      !reference_.columns->dphoto[reference_photo(scene_, reference_.example, camera)]
           .row(kLogGain)
           .isZero(0.0);
  out.photo_derivative = columns_ && (texture_gain || !columns_->dphoto[photo].isZero(0.0));
  out.gloss_derivative = moves(kSpecular);
  out.blur_derivative = moves(kBlur);
  out.vignetting_derivative = moves(kVignetting);
  out.uneven_derivative = moves(kUneven, kUnevenNumbers);
  return out;
}

void ExampleView::render(const Texture& texture, const PhotoState& state,
                         const RenderOptions& options, bool rim,
                         const std::vector<unsigned char>* count, Rendering* out) const {
  renderer_.render(x_, reference_.state ? &x_reference_ : nullptr, texture, state, options, rim,
                   count, out);
}

const VertexSensitivity& ExampleView::sensitivity(int photo, int plane, const Texture& texture,
                                                  double scale) {
  const Eigen::MatrixXd& numbers = columns_->dphoto[photo];
  S_.photo = numbers.topRows(kPhotoColumns);
  if (by_colour(scene_, example_, photo) && plane != 1)
    S_.photo.row(kZoom) += numbers.row(kColourZoom + plane / 2);
  S_.photo.row(kBlur) /= scale * scale;  // px^2
  if (reference_.columns && texture.source == Texture::Source::photo) {
    S_.second = second_on_vertices_;
    const int source = reference_photo(scene_, reference_.example,
                                       model_.examples[example_].photos[photo].camera.name);
    add_reference_photo(texture.reference_camera, x_reference_, reference_.columns->dphoto[source],
                        &S_);
  }
  if (is_mask(photo)) S_.photo.bottomRows(kPhotoColumns - kLogGain).setZero();
  return S_;
}

}  // namespace hookeye
