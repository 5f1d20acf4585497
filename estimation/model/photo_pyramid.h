// Photos at half, quarter, ... size for coarse-to-fine fits.
#pragma once

#include <memory>
#include <vector>

#include "capture_io/capture.h"

namespace hookeye {

/// One compared plane of a photo at one level. Averaging four pixels halves the noise.
struct PhotoPlane {
  SharedValue<Image> I, sigma;
  SharedValue<std::vector<unsigned char>> valid;
  std::shared_ptr<const Image> backdrop;  ///< what is behind the body; null: nobody took it
};

/// Means over squares of two by two pixels.
Image halved(const Image& image);
/// Standard deviations of those means, of independent pixels.
Image halved_sigma(const Image& sigma);
/// Where all four pixels count.
std::vector<unsigned char> halved_valid(const std::vector<unsigned char>& valid, int width,
                                        int height);

/// levels[0] is the photo itself and shares its pixels. The only file that touches OpenCV's image
/// filters here.
std::vector<PhotoPlane> photo_pyramid(const Photo& photo, int plane, int levels);

}  // namespace hookeye
