#include "runs/report/encode_png.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "capture_io/encode_png.h"

namespace hookeye {

Quantised intensity_quantum(double full) { return {full / 65534.0, 1}; }
Quantised residual_quantum() { return {1.0 / 32.0, 32768}; }

std::string encode_png16(const Image& image, const Quantised& quantum) {
  std::vector<uint16_t> codes(image.pixels(), 0);
  for (size_t p = 0; p < codes.size(); ++p) {
    const double v = image.values[p * static_cast<size_t>(image.channels)];
    if (!std::isnan(v))
      codes[p] = static_cast<uint16_t>(
          std::clamp(std::round(v / quantum.step) + quantum.zero, 1.0, 65535.0));
  }
  return encode_png(image.width, image.height, codes);
}

Image shrink(const Image& image, int factor) {
  if (factor <= 1) return image;
  Image out{(image.width + factor - 1) / factor, (image.height + factor - 1) / factor, 1, {}};
  out.values.resize(out.pixels());
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      double sum = 0.0, count = 0.0;
      for (int v = y * factor; v < std::min(image.height, (y + 1) * factor); ++v)
        for (int u = x * factor; u < std::min(image.width, (x + 1) * factor); ++u)
          if (!std::isnan(image.at(u, v))) sum += image.at(u, v), count += 1.0;
      out.at(x, y) =
          count > 0.0 ? static_cast<float>(sum / count) : std::numeric_limits<float>::quiet_NaN();
    }
  return out;
}

}  // namespace hookeye
