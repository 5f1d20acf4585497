#include "estimation/evaluation/all_pixels.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/work_clock.h"
#include "estimation/images/unresolved.h"
#include "estimation/model/photo_again.h"

namespace hookeye {

void few_at_once(size_t count, const std::function<void(size_t)>& body) {
  constexpr int kAtOnce = 2;
  tbb::task_arena few(std::min(kAtOnce, tbb::this_task_arena::max_concurrency()));
  few.execute([&] {
    tbb::parallel_for(
        size_t{0}, count, [&](size_t i) { tbb::this_task_arena::isolate([&] { body(i); }); },
        tbb::simple_partitioner());
  });
}

std::optional<Brightness> FollowedBrightness::by(const PhotoPlane& photo, const Texture& texture,
                                                 double pixels, Rendering* rendering) {
  const FitLimits& limits = scene_.limits->fit;
  if (texture.source != Texture::Source::photo || limits.brightness_cell == 0.0) return {};
  const SurfaceMesh& surface = scene_.body->surface.mesh;
  if (patches_.empty()) patches_ = smooth_patches(surface, limits.smooth_patch);
  Brightness brightness(*rendering, photo.I, photo.valid, patches_,
                        pixels * limits.brightness_cell);
  rendering->I = brightness.followed();
  return brightness;
}

Registration registration(const Image& model, const PhotoPlane& photo, const Image& residual,
                          const Image& sigma, bool mask) {
  const Working part(WorkPart::motion);
  return mask ? register_silhouettes(model, photo.I, photo.valid, residual, sigma)
              : register_pictures(model, photo.I, residual, sigma);
}

void add_flow(const Image& model, const Registration& registered, const Image& sigma, bool mask,
              PhotoEvaluation* out) {
  const Working part(WorkPart::motion);
  out->flow = residual_flow(model, registered.linear, sigma, !mask);
  out->aligned = residual_flow(model, registered.residual, sigma, !mask);
  out->linear_r2 = loss(registered.linear, 0.0);
  if (!mask) out->free_variance = variance_after_free_motion(model, registered.residual, sigma);
}

namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

const PhotoReading& reading_of(const Scene& scene, const std::string& camera) {
  return scene.readings.at(camera);
}

/// One photo of the capture as it was taken, cut to what is read of it.
Photo taken_photo(const Scene& scene, int example, int photo) {
  Photo out = read_again(scene, example, photo, Weighed::yes);
  const PhotoReading& reading = reading_of(scene, out.camera);
  const Camera& read = scene.capture.camera(out.camera);
  const int side = 1 << reading.halvings;
  cut(out,
      {reading.window.x * side, reading.window.y * side, read.width * side, read.height * side});
  return out;
}

PhotoPlane plane_of(const Photo& photo, int plane) {
  PhotoPlane out{photo.planes[plane], photo.sigma[plane], photo.valid, nullptr};
  if (!photo.backdrop.empty()) out.backdrop = photo.backdrop[plane].pointer();
  return out;
}

/// Part of a photo with room about it, whose pixels are seen and do not count.
struct Tile {
  PhotoWindow all, inner;  ///< [px of the taken photo]
  PhotoPlane photo;
};

Tile tile_of(const PhotoPlane& whole, const PhotoWindow& inner, int room) {
  const int width = whole.I->width, height = whole.I->height;
  const int x0 = std::max(0, inner.x - room), y0 = std::max(0, inner.y - room);
  const int x1 = std::min(width, inner.x + inner.width + room),
            y1 = std::min(height, inner.y + inner.height + room);
  Tile out{{x0, y0, x1 - x0, y1 - y0}, inner, {}};
  const PhotoWindow& all = out.all;
  out.photo = {cut(*whole.I, all), cut(*whole.sigma, all), {}, nullptr};
  std::vector<unsigned char> valid(out.photo.I->pixels(), 0);
  for (int y = inner.y; y < inner.y + inner.height; ++y) {
    const auto from = whole.valid->begin() + static_cast<std::ptrdiff_t>(y) * width + inner.x;
    std::copy(from, from + inner.width,
              valid.begin() + static_cast<std::ptrdiff_t>(y - y0) * all.width + (inner.x - x0));
  }
  out.photo.valid = std::move(valid);
  if (whole.backdrop) out.photo.backdrop = std::make_shared<const Image>(cut(*whole.backdrop, all));
  return out;
}

/// Such that no tile parts the pixels that are read as one.
std::vector<PhotoWindow> tiles_of(int width, int height, int side) {
  std::vector<PhotoWindow> out;
  for (int y = 0; y < height; y += side)
    for (int x = 0; x < width; x += side)
      out.push_back({x, y, std::min(side, width - x), std::min(side, height - y)});
  return out;
}

/// Pictures of the size that is read.
struct ReadPictures {
  Image model, residual;
  std::vector<int> triangle;
  double r2 = 0.0, count = 0.0;

  ReadPictures(int width, int height)
      : model{width, height, 1, {}}, residual{width, height, 1, {}} {
    model.values.assign(model.pixels(), 0.0f);
    residual.values.assign(model.pixels(), kNone);
    triangle.assign(model.pixels(), -1);
  }

  void add(const Tile& tile, int halvings, const Rendering& rendering, const Image& sigma,
           const Image& residuals) {
    const PhotoWindow at{tile.inner.x - tile.all.x, tile.inner.y - tile.all.y, tile.inner.width,
                         tile.inner.height};
    Image I = cut(rendering.I, at), photo = cut(*tile.photo.I, at), noise = cut(sigma, at);
    std::vector<unsigned char> counts;
    for (const float r : cut(residuals, at).values) counts.push_back(!std::isnan(r));
    for (int i = 0; i < halvings; ++i) {
      counts = halved_valid(counts, I.width, I.height);
      I = halved(I), photo = halved(photo), noise = halved_sigma(noise);
    }
    const int side = 1 << halvings, half = side / 2;
    for (int y = 0; y < I.height; ++y)
      for (int x = 0; x < I.width; ++x) {
        const size_t from = static_cast<size_t>(y) * I.width + x;
        const size_t to =
            static_cast<size_t>(y + tile.inner.y / side) * model.width + (x + tile.inner.x / side);
        model.values[to] = I.values[from];
        if (!rendering.triangle.empty())
          triangle[to] =
              rendering.triangle[static_cast<size_t>(y * side + half + at.y) * tile.all.width +
                                 (x * side + half + at.x)];
        if (!counts[from]) continue;
        const float r = (I.values[from] - photo.values[from]) / noise.values[from];
        residual.values[to] = r;
        r2 += double(r) * r, count += 1.0;
      }
  }
};

/// The state of the read photo as that of a tile of the taken one.
PhotoState state_of_tile(const PhotoState& read, const PhotoReading& reading, const Tile& tile) {
  PhotoState out = read;
  out.camera = as_taken(read.camera, reading);
  out.camera.cx -= tile.all.x, out.camera.cy -= tile.all.y;
  out.camera.width = tile.all.width, out.camera.height = tile.all.height;
  out.blur_variance *= std::pow(4.0, reading.halvings);
  out.backdrop = tile.photo.backdrop;
  return out;
}

/// Of a tile that is compared with a photo; else empty: it is the tile's own.
Image sigma_of(const PhotoPlane& photo, const Texture& texture, const PhotoState& state,
               const Scene& scene) {
  if (texture.source != Texture::Source::photo) return {};
  Image out = sigma_beside_photo(photo.sigma, unresolved_variance(photo.I, photo.sigma),
                                 scene.limits->fit.unresolved);
  const auto factor = static_cast<float>(sigma_of_blur(state.blur_variance).factor);
  for (float& value : out.values) value *= factor;
  return out;
}

void add_sums(CondensedPhoto sums, CondensedPhoto* all) {
  if (all->JtJ.size() == 0) {
    all->JtJ = std::move(sums.JtJ), all->Jtr = std::move(sums.Jtr);
    return;
  }
  all->JtJ += sums.JtJ, all->Jtr += sums.Jtr;
}

}  // namespace

TakenPhotos taken_photos(const ExampleView& view, int photo) {
  const Scene& scene = view.scene();
  TakenPhotos out{taken_photo(scene, view.example(), photo), {}};
  const BodySpec& body = scene.capture.body;
  if (body.texture != BodySpec::Texture::rest || view.is_mask(photo)) return out;
  const int reference = scene.example_index(body.texture_example);
  const int k = reference_photo(scene, reference, out.photo->camera);
  if (k >= 0 && reference != view.example()) out.texture = taken_photo(scene, reference, k);
  return out;
}

PhotoEvaluation compare_taken(ExampleView& view, int k, int plane, const TakenPhotos& taken,
                              const PhotoPlane& read, const Image& read_sigma, Texture texture,
                              FollowedBrightness& followed, const EvaluationOptions& options,
                              Rendering* rendering) {
  PhotoState state = view.model().examples[view.example()].photos[k];
  state.camera = camera_of_plane(view.scene(), view.example(), k, plane, state.camera);
  const PhotoReading& reading = reading_of(view.scene(), state.camera.name);
  const bool mask = view.is_mask(k), rim = view.shows_rim(k);
  if (texture.source == Texture::Source::photo) {
    texture.photo = taken.texture->planes[plane].pointer();
    texture.photo_valid = taken.texture->valid.pointer();
    texture.reference_camera = as_taken(texture.reference_camera, reading);
  }
  const PhotoPlane whole = plane_of(*taken.photo, plane);
  const RenderOptions how = view.rendering(k, texture, {0, true}, options);
  const double side = std::exp2(reading.halvings);
  // What follows brightness, and contours, are of a whole picture.
  const bool one_tile = mask || texture.source == Texture::Source::photo;
  const int tile_px = one_tile ? std::max(whole.I->width, whole.I->height) : options.tile_px;
  const double blur_px = std::sqrt(state.blur_variance) * side;
  const int room = 16 * static_cast<int>(std::ceil((4.0 + 4.0 * blur_px) / 16.0));
  PhotoEvaluation one;
  one.example = view.example(), one.photo = k, one.plane = plane;
  ReadPictures pictures(read.I->width, read.I->height);
  for (const PhotoWindow& inner : tiles_of(whole.I->width, whole.I->height, tile_px)) {
    const Tile tile = tile_of(whole, inner, room);
    PhotoState here = state_of_tile(state, reading, tile);
    if (mask) here = coverage_state(here);
    view.render(texture, here, how, rim, here.blur_variance > 0.0 ? nullptr : &*tile.photo.valid,
                rendering);
    const Image beside = sigma_of(tile.photo, texture, here, view.scene());
    const Image& sigma = beside.values.empty() ? *tile.photo.sigma : beside;
    const auto brightness = followed.by(tile.photo, texture, side, rendering);
    const Comparison comparison = compare_pixels(*rendering, tile.photo, sigma, {rim, mask}, here);
    one.taken_r2 += comparison.r2, one.taken_count += comparison.count;
    one.sums.r2 += loss(comparison.residual, options.huber);
    if (view.derivatives()) {
      const VertexSensitivity& S = view.sensitivity(k, plane, texture, 1.0 / side);
      const Working part(WorkPart::sums);
      if (texture.source == Texture::Source::photo && how.blur_derivative)
        add_sigma_of_blur(sigma_of_blur(here.blur_variance), comparison.residual, sigma,
                          &rendering->dI);
      add_sums(condense(*rendering, comparison.residual, sigma, view.mesh(), here, options.huber,
                        brightness ? &*brightness : nullptr, S),
               &one.sums);
    }
    pictures.add(tile, reading.halvings, *rendering, sigma, comparison.residual);
  }
  one.r2 = pictures.r2, one.count = pictures.count;
  const Registration registered =
      registration(pictures.model, read, pictures.residual, read_sigma, mask);
  one.motion_px = registered.rms_px;
  add_flow(pictures.model, registered, read_sigma, mask, &one);
  one.triangle = std::move(pictures.triangle);
  one.model = std::move(pictures.model);
  one.residual = std::move(pictures.residual);
  return one;
}

}  // namespace hookeye
