// Photos at half, quarter, ... size for coarse-to-fine fits.
#pragma once

#include <vector>

#include "capture_io/capture.h"

namespace hookeye {

/// One compared plane of a photo at one level. Averaging four pixels halves the noise.
struct PhotoPlane {
  Image I, sigma;
  std::vector<unsigned char> valid;
};

/// Means over squares of two by two pixels.
Image halved(const Image& image);

/// levels[0] is the photo itself. The only file that touches OpenCV's image filters here.
std::vector<PhotoPlane> photo_pyramid(const Photo& photo, int plane, int levels);

}  // namespace hookeye
