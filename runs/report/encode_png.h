// Pictures as the page reads them: 16-bit grey PNG with a stated step, decoded without loss there.
#pragma once

#include <string>

#include "capture_io/image.h"

namespace hookeye {

/// value = (code - zero) * step; code 0 means "does not count".
struct Quantised {
  double step = 1.0;
  int zero = 0;
};

/// Intensities 0..1 and a little beyond: steps of 1/65535 of `full`.
Quantised intensity_quantum(double full);
/// Residuals over noise: steps of 1/32 up to +-1024, a hundredth of what noise alone scatters.
Quantised residual_quantum();

/// 1-channel picture as PNG. NaN becomes 0.
std::string encode_png16(const Image& image, const Quantised& quantum);

/// Mean of `factor` x `factor` blocks, NaN left out; edge blocks may be smaller.
Image shrink(const Image& image, int factor);

}  // namespace hookeye
