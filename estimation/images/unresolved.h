// What a texture sampled from a photo cannot know: pixels that are too large for the pattern.
#pragma once

#include "capture_io/image.h"

namespace hookeye {

/// Local variance [square of intensity, by pixel] of what cubic B-splines lose of a picture that is
/// moved by half a pixel and back, along its rows and along its columns, less what they lose of its
/// noise (`sigma`, independent pixels). Near Nyquist's frequency half is lost, and what lies beyond
/// has been folded there. Another photo of the same pattern, moved by a part of a pixel, differs
/// from the interpolated picture by 0.6 to 1.7 times that where pixels are apertures without blur,
/// by less where a lens blurs (tests/estimation/images/unresolved_test.cpp).
Image unresolved_variance(const Image& image, const Image& sigma);

/// Of the noise of a photo that is interpolated by cubic B-splines, over all parts of a pixel.
struct BlurredNoise {
  double share;        ///< of its variance that blur() leaves
  double by_variance;  ///< derivative of that [1/px^2]
};
BlurredNoise blurred_noise(double blur_variance_px2);

}  // namespace hookeye
