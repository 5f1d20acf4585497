// Photos as linear intensities with a noise model. OpenImageIO reads and writes them, in a helper:
// helpers/pictures.cpp.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/input_error.h"

namespace hookeye {

/// How stored values map to linear intensity; full scale is 1.
struct Encoding {
  enum class Kind { linear, srgb, gamma } kind = Kind::linear;
  double gamma = 1.0;  ///< used by Kind::gamma: linear = stored^gamma
};

/// Linear picture, row-major, channels interleaved. Pixel (0,0) is the top left one and its
/// centre has the coordinates (0,0).
struct Image {
  int width = 0, height = 0, channels = 0;
  std::vector<float> values;  ///< width*height*channels
  float at(int x, int y, int c = 0) const {
    return values[(static_cast<size_t>(y) * width + x) * channels + c];
  }
  float& at(int x, int y, int c = 0) {
    return values[(static_cast<size_t>(y) * width + x) * channels + c];
  }
  size_t pixels() const { return static_cast<size_t>(width) * height; }
};

/// Standard deviation of one pixel of one channel at linear intensity I (full scale 1):
/// sigma^2 = read^2 + max(I, 0) / full_well, or constant where full_well is 0.
struct NoiseModel {
  double full_well = 0.0;  ///< electrons at full scale; 0: no photon noise
  double read = 0.0;       ///< [full scale]
  bool estimated = false;  ///< true where the capture gave none and estimate_noise() did
  bool doubtful = false;   ///< estimated where the photo hardly tells it
  double sigma(double intensity) const;
};

/// What the header says, read without decoding the pixels. Throws InputError (place = file).
struct ImageHeader {
  int width = 0, height = 0, channels = 0, bits = 0;
  bool floating = false;
  bool lossy = false;  ///< JPEG
};
ImageHeader read_image_header(const std::filesystem::path& file);

/// Reads PNG, TIFF, JPEG, EXR (and camera RAW where the reader can). Encoding defaults: linear for
/// floating-point files and 16 bit, srgb for 8 bit. Alpha is dropped; 1 or 3 channels remain.
/// Throws InputError: missing, truncated, unreadable, claimed size above 1 Gpixel.
Image read_image(const std::filesystem::path& file, std::optional<Encoding> encoding = {});

/// A file that the capture names, and where it does.
struct NamedFile {
  std::filesystem::path path;
  Place place;
};
/// The same; what is wrong with the file is told where the capture names it.
Image read_image(const NamedFile& file, std::optional<Encoding> encoding = {});

/// A float picture in which NaN means "does not count" (residuals); values as stored.
Image read_image_with_holes(const std::filesystem::path& file);

/// Written whole or not at all (temporary name, then rename). Format by extension: .exr (float or
/// half), .png (8 bit), .tif (16 bit). Values are linear; png and tif are stored with `encoding`.
/// `dither_free` values are rounded to the nearest level.
void write_image(const std::filesystem::path& file, const Image& image, Encoding encoding = {});

/// Rec. 709 luminance of a 3-channel linear image; 1-channel images are returned unchanged.
Image luminance(const Image& image);

/// Noise standard deviation against intensity from one photo alone: robust fit of
/// sigma^2(I) = read^2 + I/full_well to high-pass residuals of its calmest blocks (image_noise.cpp)
/// or, where texture fills the photo, of its calmest spots (calm_noise.cpp). Not `white`, as that
/// of a JPEG: from the blocks alone.
NoiseModel estimate_noise(const Image& image, bool white = true);

}  // namespace hookeye
