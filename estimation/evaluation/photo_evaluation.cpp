#include "estimation/evaluation/photo_evaluation.h"

#include <Eigen/LU>
#include <cmath>
#include <optional>

#include "core/work_clock.h"
#include "estimation/evaluation/compared_pixels.h"

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

/// Photos of coarse levels are means over squares of pixels: a wider filter with rays enough to see
/// every speckle once (a box has 2.5 times the variance of the 1.5 px window). A texture that is a
/// photo went through the camera's aperture once already: one ray a pixel, or the model would be
/// blurred twice and every motion come out too long.
RenderOptions at_level(RenderOptions options, int level, int halvings, const Texture& texture,
                       bool single_rays = false) {
  if (level == 0 && (single_rays || texture.source == Texture::Source::photo))
    options.rays_per_axis = 1, options.filter_width_px = 1.0;
  else if (level == 0 && halvings > 0)
    options.halvings = halvings, options.rays_per_axis = kRaysOfHalved;
  if (level == 0) return options;
  options.rays_per_axis = std::min(1 + 3 * level, 15);
  options.filter_width_px = 2.4;
  return options;
}

}  // namespace

struct PhotoComparer::Impl {
  std::shared_ptr<const Scene> scene;
  int example;
  Renderer renderer;
  std::vector<std::vector<std::vector<PhotoPlane>>> pyramids;  ///< [photo][plane][level]
  std::vector<int> patches;  ///< smooth_patches(); empty: not asked for yet
  static constexpr int kLevels = 6;

  Impl(std::shared_ptr<const Scene> s, int e)
      : scene(std::move(s)), example(e), renderer(scene->body->surface.mesh) {}

  const PhotoPlane& plane(int photo, int plane, int level) {
    if (pyramids.empty())
      for (const Photo& one : scene->photos[example]) {
        std::vector<std::vector<PhotoPlane>> planes;
        for (size_t k = 0; k < one.planes.size(); ++k)
          planes.push_back(photo_pyramid(one, static_cast<int>(k), kLevels));
        pyramids.push_back(std::move(planes));
      }
    return pyramids[photo][plane][std::min(level, kLevels - 1)];
  }

  /// The model's picture takes the photo's brightness where the texture brought its light along.
  std::optional<Brightness> follow(const PhotoPlane& photo, const Texture& texture,
                                   Rendering* rendering) {
    const FitLimits& limits = scene->limits->fit;
    if (texture.source != Texture::Source::photo || limits.brightness_cell == 0.0) return {};
    const SurfaceMesh& surface = scene->body->surface.mesh;
    if (patches.empty()) patches = smooth_patches(surface, limits.smooth_patch);
    Brightness brightness(*rendering, photo.I, photo.valid, patches, limits.brightness_cell);
    rendering->I = brightness.followed();
    return brightness;
  }
};

PhotoComparer::PhotoComparer(std::shared_ptr<const Scene> scene, int example)
    : impl_(std::make_unique<Impl>(std::move(scene), example)) {}
PhotoComparer::PhotoComparer(PhotoComparer&&) noexcept = default;
PhotoComparer::~PhotoComparer() = default;

namespace {

PhotoState state_at_level(const PhotoState& state, int level) {
  PhotoState coarse = state;
  coarse.camera = camera_at_level(state.camera, level);
  coarse.blur_variance *= std::pow(0.25, level);
  return coarse;
}

bool is_silhouette(const Scene& scene, int example, int photo) {
  return scene.capture.examples[example].photos[photo].kind == PhotoSpec::Kind::silhouette;
}

/// Index of the reference example's photo by the same camera, -1: none.
int reference_photo(const Scene& scene, int reference, const std::string& camera) {
  const auto& photos = scene.capture.examples[reference].photos;
  for (size_t k = 0; k < photos.size(); ++k)
    if (photos[k].camera == camera) return static_cast<int>(k);
  return -1;
}

/// Colour source of one photo. False: this photo cannot be compared (no reference photo).
bool choose_texture(const Scene& scene, const Model& model, int example, int photo, int plane,
                    int level, Texture& texture) {
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
    const int halvings = scene.halvings_of(camera);
    const int rays = level > 0      ? std::min(1 + 3 * level, 15)
                     : halvings > 0 ? kRaysOfHalved
                                    : RenderOptions{}.rays_per_axis;
    const double apart = std::exp2(level + halvings) / rays;
    texture.image = sizes[std::min<size_t>(apart > 1.4   ? 2
                                           : apart > 0.7 ? 1
                                                         : 0,
                                           sizes.size() - 1)];
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
  texture.reference_camera = model.examples[reference].photos[k].camera;
  texture.reference_gain = model.examples[reference].photos[k].gain;
  return true;
}

/// Silhouettes are rendered as plain coverage: no light, and no sky that concave parts miss.
PhotoState coverage_state(PhotoState state) {
  state.gain = 1.0;
  state.shaded = false;
  state.sun.setZero();
  state.specular = 0.0;
  state.background = 0.0;
  state.backdrop = nullptr;
  return state;
}

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

Rendering PhotoComparer::render(const Model& model, const VectorXd& q, const VectorXd* q_reference,
                                int photo, int plane, const RenderOptions& options) {
  const Scene& scene = *impl_->scene;
  Texture texture;
  choose_texture(scene, model, impl_->example, photo, plane, 0, texture);
  const RenderSurface& surface = scene.body->surface;
  const Matrix3Xd x = surface.deformed(scene.body->mesh, q);
  Matrix3Xd x_reference;
  if (q_reference) x_reference = surface.deformed(scene.body->mesh, *q_reference);
  PhotoState state = model.examples[impl_->example].photos[photo];
  const auto& photos = scene.photos[impl_->example];
  if (photo < static_cast<int>(photos.size()) && !photos[photo].backdrop.empty())
    state.backdrop = photos[photo].backdrop[plane].pointer();
  if (is_silhouette(scene, impl_->example, photo)) state = coverage_state(state);
  return impl_->renderer.render(x, q_reference ? &x_reference : nullptr, texture, state,
                                at_level(options, 0, scene.halvings_of(state.camera.name), texture),
                                true);
}

std::vector<PhotoEvaluation> PhotoComparer::compare(const Model& model,
                                                    const ExampleEvaluation& example,
                                                    const ReferenceState& reference,
                                                    const ExampleColumns* columns,
                                                    const EvaluationOptions& options) {
  std::vector<PhotoEvaluation> all;
  const Scene& scene = *impl_->scene;
  const int e = impl_->example;
  if (scene.photos[e].empty() || e == reference.example) return all;
  const RenderSurface& surface = scene.body->surface;
  const Matrix3Xd x = surface.deformed(scene.body->mesh, example.equilibrium->q);
  Matrix3Xd x_reference;
  if (reference.state)
    x_reference = surface.deformed(scene.body->mesh, reference.state->equilibrium->q);
  const RenderOptions base_options = render_options(scene);
  const bool has_light = scene.capture.body.texture != BodySpec::Texture::rest;
  VertexSensitivity S;
  if (columns)
    S = vertex_sensitivity(impl_->renderer, surface, x, example.S,
                           reference.state ? &reference.state->S : nullptr, has_light);
  const RowMatrix second_on_vertices = S.second;
  Rendering rendering;  // one for all photos: its memory is used again
  Image larger_sigma;

  for (size_t k = 0; k < scene.photos[e].size(); ++k)
    for (size_t plane = 0; plane < scene.photos[e][k].planes.size(); ++plane) {
      Texture texture;
      if (!choose_texture(scene, model, e, static_cast<int>(k), static_cast<int>(plane),
                          options.level, texture))
        continue;
      const bool mask_photo = is_silhouette(scene, e, static_cast<int>(k));
      const bool silhouette = mask_photo || scene.capture.examples[e].photos[k].background.kind !=
                                                BackgroundSpec::Kind::ignore;
      // A photo texture is interpolated from the full-size photo at every level.
      const PhotoPlane& photo =
          impl_->plane(static_cast<int>(k), static_cast<int>(plane), options.level);
      PhotoState state = state_at_level(model.examples[e].photos[k], options.level);
      state.backdrop = photo.backdrop;
      if (mask_photo) state = coverage_state(state);
      RenderOptions render_options =
          at_level(base_options, options.level, scene.halvings_of(state.camera.name), texture,
                   options.single_rays);
      render_options.derivatives = columns != nullptr;
      render_options.parallel = true;
      const auto moves = [&](PhotoColumn column) {
        return columns != nullptr && !columns->dphoto[k].row(column).isZero(0.0);
      };
      // The texture is divided by the gain of the photo that it is from.
      const bool texture_gain =
          columns != nullptr && reference.columns && texture.source == Texture::Source::photo &&
          !reference.columns
               ->dphoto[reference_photo(scene, reference.example,
                                        model.examples[e].photos[k].camera.name)]
               .row(kLogGain)
               .isZero(0.0);
      render_options.photo_derivative =
          columns != nullptr && (texture_gain || !columns->dphoto[k].isZero(0.0));
      render_options.gloss_derivative = moves(kSpecular);
      render_options.blur_derivative = moves(kBlur);
      render_options.centres = options.pictures || texture.source == Texture::Source::photo;
      // Where there is blur, masked pixels are seen in their neighbours. A motion is looked for in
      // whole pictures.
      const bool all_pixels = state.blur_variance > 0.0 || options.registered;
      impl_->renderer.render(x, reference.state ? &x_reference : nullptr, texture, state,
                             render_options, silhouette, all_pixels ? nullptr : &*photo.valid,
                             &rendering);
      const Image& sigma = compared_sigma(photo, texture, &larger_sigma);
      const std::optional<Brightness> brightness = impl_->follow(photo, texture, &rendering);
      const Comparison comparison =
          compare_pixels(rendering, photo, sigma, {silhouette, mask_photo}, state);
      PhotoEvaluation one;
      one.example = e;
      one.photo = static_cast<int>(k);
      one.plane = static_cast<int>(plane);
      one.r2 = comparison.r2;
      one.count = comparison.count;
      std::optional<Registration> registered;
      if (options.pictures || options.registered) {
        const Working part(WorkPart::motion);
        registered = mask_photo
                         ? register_silhouettes(rendering.I, photo.I, photo.valid,
                                                comparison.residual, sigma)
                         : register_pictures(rendering.I, photo.I, comparison.residual, sigma);
      }
      if (registered) one.motion_px = registered->rms_px;
      const Image& residual = registered ? registered->linear : comparison.residual;
      if (columns) {
        S.photo = columns->dphoto[k];
        S.photo.row(kBlur) *= std::pow(0.25, options.level);  // px^2 of this level
        if (reference.columns && texture.source == Texture::Source::photo) {
          S.second = second_on_vertices;
          const int source =
              reference_photo(scene, reference.example, model.examples[e].photos[k].camera.name);
          add_reference_photo(texture.reference_camera, x_reference,
                              reference.columns->dphoto[source], &S);
        }
        if (mask_photo) S.photo.bottomRows(kPhotoColumns - kLogGain).setZero();
        const Working part(WorkPart::sums);
        one.sums = condense(rendering, residual, sigma, surface.mesh, state, options.huber,
                            brightness ? &*brightness : nullptr, S);
      }
      one.sums.r2 = loss(options.registered ? residual : comparison.residual, options.huber);
      if (options.pictures) {
        const Working part(WorkPart::motion);
        one.flow = residual_flow(rendering.I, residual, sigma, !mask_photo);
        const Image& rest = registered ? registered->residual : residual;
        one.aligned = residual_flow(rendering.I, rest, sigma, !mask_photo);
        one.linear_r2 = loss(residual, 0.0);
        if (!mask_photo) one.free_variance = variance_after_free_motion(rendering.I, rest, sigma);
        one.triangle = std::move(rendering.triangle);
      }
      if (options.pictures || options.residuals) {
        one.model = std::move(rendering.I);
        one.residual = options.registered ? residual : comparison.residual;
      }
      all.push_back(std::move(one));
    }
  return all;
}

}  // namespace hookeye
