#include "estimation/evaluation/photo_evaluation.h"

#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "core/work_clock.h"
#include "estimation/evaluation/all_pixels.h"
#include "estimation/evaluation/compared_pixels.h"
#include "estimation/evaluation/photo_view.h"
#include "estimation/images/unresolved.h"

namespace hookeye {

struct PhotoComparer::Impl {
  std::shared_ptr<const Scene> scene;
  int example;
  Renderer renderer;
  PhotoPlane whole;  ///< the one that was asked for last, which shares the scene's pixels
  std::vector<std::vector<std::vector<PhotoPlane>>> pyramids;  ///< [photo][plane][level]
  std::map<std::array<int, 3>, Image> beside_photo;            ///< the same: sigma_beside_photo()
  Image blurred_sigma;
  FollowedBrightness followed;
  static constexpr int kLevels = 6;

  Impl(std::shared_ptr<const Scene> s, int e)
      : scene(std::move(s)), example(e), renderer(scene->body->surface.mesh), followed(*scene) {}

  /// Until the next is asked for. Coarse levels are made when one of them is asked for, and go with
  /// the first that is not: a fit ends with whole photos, and most commands see nothing else.
  const PhotoPlane& plane(int photo, int plane, int level) {
    if (level == 0) {
      pyramids = {};
      std::erase_if(beside_photo, [](const auto& one) { return one.first[2] > 0; });
      return whole = photo_pyramid(scene->photos[example][photo], plane, 1).front();
    }
    if (pyramids.empty())
      for (const Photo& one : scene->photos[example]) {
        std::vector<std::vector<PhotoPlane>> planes;
        for (size_t k = 0; k < one.planes.size(); ++k)
          planes.push_back(photo_pyramid(one, static_cast<int>(k), kLevels));
        pyramids.push_back(std::move(planes));
      }
    return pyramids[photo][plane][std::min(level, kLevels - 1)];
  }

  /// Of the plane that was asked for last, compared with `texture`, blurred by `blur` [px^2 of that
  /// level]. Holds as long.
  const Image& sigma(const PhotoPlane& compared, std::array<int, 3> of, const Texture& texture,
                     double blur) {
    if (texture.source != Texture::Source::photo) return compared.sigma;
    const Image& sharp = sigma_of_sharp(compared, of);
    if (blur == 0.0) return sharp;
    blurred_sigma = sharp;
    const auto factor = static_cast<float>(sigma_of_blur(blur).factor);
    for (float& value : blurred_sigma.values) value *= factor;
    return blurred_sigma;
  }

  const Image& sigma_of_sharp(const PhotoPlane& compared, std::array<int, 3> of) {
    const auto [at, fresh] = beside_photo.try_emplace(of);
    if (!fresh) return at->second;
    const auto [photo, plane, level] = of;
    const Photo& taken = scene->photos[example][photo];
    Image unresolved = unresolved_variance(taken.planes[plane], taken.sigma[plane]);
    for (int i = 0; i < std::min(level, kLevels - 1); ++i) {
      unresolved = halved(unresolved);
      for (float& variance : unresolved.values) variance /= 4.0f;  // as of independent pixels
    }
    at->second = sigma_beside_photo(compared.sigma, unresolved, scene->limits->fit.unresolved);
    return at->second;
  }
};

PhotoComparer::PhotoComparer(std::shared_ptr<const Scene> scene, int example)
    : impl_(std::make_unique<Impl>(std::move(scene), example)) {}
PhotoComparer::PhotoComparer(PhotoComparer&&) noexcept = default;
PhotoComparer& PhotoComparer::operator=(PhotoComparer&&) noexcept = default;
PhotoComparer::~PhotoComparer() = default;

Rendering PhotoComparer::render(const Model& model, const VectorXd& q, const VectorXd* q_reference,
                                int photo, int plane, const RenderOptions& options) {
  const Scene& scene = *impl_->scene;
  Texture texture;
  choose_texture(scene, model, impl_->example, photo, plane, {}, texture);
  const RenderSurface& surface = scene.body->surface;
  const Matrix3Xd x = surface.deformed(scene.body->mesh, q);
  Matrix3Xd x_reference;
  if (q_reference) x_reference = surface.deformed(scene.body->mesh, *q_reference);
  PhotoState state = model.examples[impl_->example].photos[photo];
  const auto& photos = scene.photos[impl_->example];
  if (photo < static_cast<int>(photos.size()))
    state.camera = camera_of_plane(scene, impl_->example, photo, plane, state.camera);
  if (photo < static_cast<int>(photos.size()) && !photos[photo].backdrop.empty())
    state.backdrop = photos[photo].backdrop[plane].pointer();
  if (is_silhouette(scene, impl_->example, photo)) state = coverage_state(state);
  return impl_->renderer.render(x, q_reference ? &x_reference : nullptr, texture, state,
                                at_level(options, 0, scene.halvings_of(state.camera.name), texture),
                                true);
}

namespace {

/// One plane of one photo as it is read, at a pyramid level.
PhotoEvaluation compare_read(ExampleView& view, int k, int plane, const PhotoPlane& photo,
                             const Image& sigma, const Texture& texture,
                             FollowedBrightness& followed, const EvaluationOptions& options,
                             Rendering* rendering) {
  const bool mask_photo = view.is_mask(k), rim = view.shows_rim(k);
  PhotoState state = view.model().examples[view.example()].photos[k];
  state.camera = camera_of_plane(view.scene(), view.example(), k, plane, state.camera);
  state = state_at_level(state, options.level);
  state.backdrop = photo.backdrop;
  if (mask_photo) state = coverage_state(state);
  // Where there is blur, masked pixels are seen in their neighbours. A motion is looked for in
  // whole pictures.
  const bool all_pixels = state.blur_variance > 0.0 || options.registered;
  const RenderOptions how = view.rendering(k, texture, {options.level, false}, options);
  view.render(texture, state, how, rim, all_pixels ? nullptr : &*photo.valid, rendering);
  const std::optional<Brightness> brightness = followed.by(photo, texture, 1.0, rendering);
  const Comparison comparison = compare_pixels(*rendering, photo, sigma, {rim, mask_photo}, state);
  PhotoEvaluation one;
  one.example = view.example();
  one.photo = k;
  one.plane = plane;
  one.r2 = comparison.r2;
  one.count = comparison.count;
  std::optional<Registration> registered;
  if (options.pictures || options.registered)
    registered = registration(rendering->I, photo, comparison.residual, sigma, mask_photo);
  if (registered) one.motion_px = registered->rms_px;
  const Image& residual = registered ? registered->linear : comparison.residual;
  if (view.derivatives()) {
    const VertexSensitivity& S = view.sensitivity(k, plane, texture, std::exp2(options.level));
    const Working part(WorkPart::sums);
    if (texture.source == Texture::Source::photo && how.blur_derivative)
      add_sigma_of_blur(sigma_of_blur(state.blur_variance), residual, sigma, &rendering->dI);
    one.sums = condense(*rendering, residual, sigma, view.mesh(), state, options.huber,
                        brightness ? &*brightness : nullptr, S);
  }
  one.sums.r2 = loss(options.registered ? residual : comparison.residual, options.huber);
  if (options.pictures) {
    add_flow(rendering->I, *registered, sigma, mask_photo, &one);
    one.triangle = std::move(rendering->triangle);
  }
  if (options.pictures || options.residuals) {
    one.model = std::move(rendering->I);
    one.residual = options.registered ? residual : comparison.residual;
  }
  return one;
}

}  // namespace

std::vector<PhotoEvaluation> PhotoComparer::compare(const Model& model,
                                                    const ExampleEvaluation& example,
                                                    const ReferenceState& reference,
                                                    const ExampleColumns* columns,
                                                    const EvaluationOptions& options) {
  std::vector<PhotoEvaluation> all;
  const Scene& scene = *impl_->scene;
  const int e = impl_->example;
  if (scene.photos[e].empty() || e == reference.example) return all;
  ExampleView view(scene, impl_->renderer, model, example, reference, columns);
  Rendering rendering;  // one for all photos: its memory is used again
  for (size_t i = 0; i < scene.photos[e].size(); ++i) {
    const int k = static_cast<int>(i);
    const bool whole = options.all_pixels && scene.in_part(scene.photos[e][i].camera);
    TakenPhotos taken;
    for (size_t p = 0; p < scene.photos[e][i].planes.size(); ++p) {
      const int plane = static_cast<int>(p);
      Texture texture;
      // A photo texture is interpolated from the full-size photo at every level.
      const PhotoSize size{options.level, whole, options.rays_per_axis};
      if (!choose_texture(scene, model, e, k, plane, size, texture)) continue;
      const PhotoPlane& photo = impl_->plane(k, plane, whole ? 0 : options.level);
      if (whole && taken.empty()) taken = taken_photos(view, k);
      const int level = whole ? 0 : options.level;
      const double blur =
          model.examples[static_cast<size_t>(e)].photos[i].blur_variance * std::pow(0.25, level);
      const Image& sigma = impl_->sigma(photo, {k, plane, level}, texture, blur);
      all.push_back(whole ? compare_taken(view, k, plane, taken, photo, sigma, texture,
                                          impl_->followed, options, &rendering)
                          : compare_read(view, k, plane, photo, sigma, texture, impl_->followed,
                                         options, &rendering));
    }
  }
  return all;
}

}  // namespace hookeye
