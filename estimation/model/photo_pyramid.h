// Photos at half, quarter, ... size for coarse-to-fine fits.
#pragma once

#include <memory>
#include <vector>

#include "capture_io/capture.h"

namespace hookeye {

/// One compared plane of a photo at one level. Averaging four pixels halves the noise.
struct PhotoPlane {
  Image I, sigma;
  std::vector<unsigned char> valid;
  std::shared_ptr<const Image> backdrop;  ///< what is behind the body; null: nobody took it
};

/// Means over squares of two by two pixels.
Image halved(const Image& image);

/// levels[0] is the photo itself. The only file that touches OpenCV's image filters here.
std::vector<PhotoPlane> photo_pyramid(const Photo& photo, int plane, int levels);

}  // namespace hookeye
