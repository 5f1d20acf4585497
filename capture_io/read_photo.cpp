#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <tuple>

#include "capture_io/capture.h"
#include "capture_io/photo_reader.h"

namespace hookeye {
namespace {

constexpr double saturated = 0.999;  ///< of full scale, formats of integers only
/// A binary silhouette rounds a pixel's coverage: uniform over one level.
const double binary_sigma = 1.0 / std::sqrt(12.0);

void check_size(const PhotoSpec& spec, const std::string& what, const Image& image,
                const Camera& camera) {
  if (image.width == camera.width && image.height == camera.height) return;
  throw InputError(spec.place,
                   fmt::format("{} has {} x {} pixels, camera `{}` has {} x {}", what, image.width,
                               image.height, camera.name, camera.width, camera.height),
                   "photos are compared at the size that the camera was calibrated for");
}

Image plane_of(const Image& image, int channel) {
  Image plane{image.width, image.height, 1, {}};
  plane.values.resize(image.pixels());
  for (size_t p = 0; p < image.pixels(); ++p)
    plane.values[p] = image.values[p * image.channels + channel];
  return plane;
}

/// Every value replaced by the mean of its up to eight neighbours. A pixel's own noise must not
/// decide its weight: photons that it happens to have too many of would make it count less, and the
/// mean brightness of a photo would come out too low by 1/full_well (4.5 standard errors of an
/// exposure at 2e5 pixels).
Image without_own(const Image& image) {
  if (image.width < 2 || image.height < 2) return image;
  Image out = image;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < image.channels; ++c) {
        double sum = -image.at(x, y, c), count = -1.0;
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, image.height - 1); ++v)
          for (int u = std::max(x - 1, 0); u <= std::min(x + 1, image.width - 1); ++u)
            sum += image.at(u, v, c), count += 1.0;
        out.at(x, y, c) = static_cast<float>(sum / count);
      }
  return out;
}

Image sigma_of(const Image& plane, const NoiseModel& noise) {
  Image sigma = without_own(plane);
  for (float& value : sigma.values) value = static_cast<float>(noise.sigma(value));
  return sigma;
}

/// sigma^2 = sum w_c^2 sigma_c^2: the channels' noise is independent.
Image luminance_sigma(const Image& image, const NoiseModel& noise,
                      const std::vector<double>& weights) {
  Image sigma{image.width, image.height, 1, {}};
  sigma.values.resize(image.pixels());
  const Image level = without_own(image);
  for (size_t p = 0; p < image.pixels(); ++p) {
    double variance = 0;
    for (int c = 0; c < image.channels; ++c)
      variance += std::pow(weights[c] * noise.sigma(level.values[p * image.channels + c]), 2);
    sigma.values[p] = static_cast<float>(std::sqrt(variance));
  }
  return sigma;
}

/// An estimate never falls below what rounding to levels adds (one level / sqrt 12).
NoiseModel estimated_noise(const Image& image, const ImageHeader& header) {
  NoiseModel noise = estimate_noise(image, !header.lossy);
  const double level = header.floating ? 1e-6 : std::exp2(-header.bits);
  noise.read = std::max(noise.read, level / std::sqrt(12.0));
  return noise;
}

/// Masks and photos of what is behind the body, which many photos share.
using Planes = std::vector<SharedValue<Image>>;

/// The part of a photo that counts, where a mask is told.
Planes mask_of(const PhotoSpec& spec) {
  return {luminance(read_image(NamedFile{spec.mask, spec.place}, Encoding{}))};
}

/// The empty scene, taken as the photo was: by channels or in grey.
Planes planes_behind(const PhotoSpec& spec, bool by_channel) {
  Image empty = read_image(NamedFile{spec.background.photo, spec.place}, spec.encoding);
  if (empty.channels == 1) return {std::move(empty)};
  if (!by_channel) return {luminance(empty)};
  return {plane_of(empty, 0), plane_of(empty, 1), plane_of(empty, 2)};
}

}  // namespace

struct PhotoReader::Shared {
  /// File, how it is read, and how it is decoded.
  using Key = std::tuple<std::filesystem::path, int, int, double>;
  std::mutex mutex;
  std::map<Key, Planes> known;

  template <class Read>
  Planes planes(const Key& key, const Read& read) {
    const std::lock_guard lock(mutex);
    const auto found = known.find(key);
    return found != known.end() ? found->second : known.emplace(key, read()).first->second;
  }
};

namespace {

void mark_invalid(const PhotoSpec& spec, const Camera& camera, const Image& image, bool floating,
                  PhotoReader::Shared& shared, Photo& photo) {
  std::vector<unsigned char>& valid = photo.valid.own();
  valid.assign(image.pixels(), 1);
  if (!floating && photo.kind == PhotoSpec::Kind::image)
    for (size_t i = 0; i < image.values.size(); ++i)
      if (image.values[i] >= saturated) valid[i / image.channels] = 0;
  if (spec.mask.empty()) return;
  const Planes planes = shared.planes({spec.mask, 0, 0, 1.0}, [&] { return mask_of(spec); });
  const Image& mask = planes.front();
  check_size(spec, "the mask", mask, camera);
  for (size_t p = 0; p < mask.pixels(); ++p)
    if (mask.values[p] < 0.5f) valid[p] = 0;
}

/// The empty scene, taken as the photo was: by planes like the photo's own.
Planes backdrop_of(const PhotoSpec& spec, const Camera& camera, bool by_channel,
                   PhotoReader::Shared& shared) {
  if (spec.background.kind != BackgroundSpec::Kind::photo) return {};
  const int usual = -1;
  const int kind = spec.encoding ? static_cast<int>(spec.encoding->kind) : usual;
  const double gamma = spec.encoding ? spec.encoding->gamma : 1.0;
  Planes planes = shared.planes({spec.background.photo, by_channel ? 3 : 1, kind, gamma},
                                [&] { return planes_behind(spec, by_channel); });
  check_size(spec, "the photo of the background", planes.front(), camera);
  if (by_channel && planes.size() == 1) planes.resize(3, planes.front());
  return planes;
}

}  // namespace

ImageHeader header_of(const PhotoSpec& spec) {
  try {
    return read_image_header(spec.file);
  } catch (const InputError& error) {
    throw told_at(spec.place, error);
  }
}

PhotoReader::PhotoReader() : shared_(std::make_unique<Shared>()) {}
PhotoReader::~PhotoReader() = default;

Photo PhotoReader::read(const PhotoSpec& spec, const Camera& camera, Weighed weighed) {
  Photo photo;
  photo.camera = spec.camera;
  photo.kind = spec.kind;
  const ImageHeader header = header_of(spec);
  const bool silhouette = spec.kind == PhotoSpec::Kind::silhouette;
  std::optional<Encoding> encoding = spec.encoding;
  if (silhouette && !encoding) encoding = Encoding{};  // a coverage, not a brightness
  Image image = read_image(NamedFile{spec.file, spec.place}, encoding);
  check_size(spec, "the photo", image, camera);
  if (spec.noise)
    photo.noise = *spec.noise;
  else if (silhouette)
    photo.noise = {0.0, binary_sigma, true};
  else
    photo.noise = estimated_noise(image, header);
  mark_invalid(spec, camera, image, header.floating, *shared_, photo);
  photo.backdrop = backdrop_of(spec, camera, spec.rgb && image.channels == 3, *shared_);
  if (spec.rgb && image.channels == 3) {
    photo.channel_weights = {1, 1, 1};
    for (int c = 0; c < 3; ++c) {
      photo.planes.push_back(plane_of(image, c));
      if (weighed == Weighed::yes)
        photo.sigma.push_back(sigma_of(photo.planes.back(), photo.noise));
    }
    return photo;
  }
  photo.channel_weights = {1};
  if (image.channels == 3) photo.channel_weights = {0.2126, 0.7152, 0.0722};
  if (weighed == Weighed::yes)
    photo.sigma.emplace_back(luminance_sigma(image, photo.noise, photo.channel_weights));
  photo.planes.emplace_back(image.channels == 1 ? std::move(image) : luminance(image));
  return photo;
}

Photo read_photo(const PhotoSpec& spec, const Camera& camera) {
  return PhotoReader().read(spec, camera, Weighed::yes);
}

}  // namespace hookeye
