// Do the photos use the range of values that their files have: 12 bits stored in 16, 8 bits
// widened?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimation/inspection/codes.h"
#include "estimation/inspection/question.h"

namespace hookeye::inspection {

void ask_photo_range(Sight& sight, Warnings& warnings) {
  for (const Codes& codes : stored_codes(sight)) {
    if (codes.bits != 16 || codes.largest == 0) continue;
    const PhotoSpec& spec = sight.spec(codes.first);
    if (codes.divisor == 257) {
      if (!spec.encoding)
        warnings.say(
            spec.place,
            fmt::format("the photos of camera `{}` hold 8 bits widened to 16 (all values are "
                        "multiples of 257), and 16 bits are taken for linear",
                        spec.camera),
            "say `encoding: srgb` if the camera wrote 8 bits for a screen, else `encoding: "
            "linear`");
      continue;
    }
    const int bits = static_cast<int>(std::ceil(std::log2(codes.largest + 1.0)));
    if (bits > sight.options().most_bits_of_16) continue;
    const int likely = bits <= 8 ? 8 : bits <= 10 ? 10 : 12;
    warnings.say(
        spec.place,
        fmt::format("the largest value in photos of camera `{}` is {} of 65535: {} bits "
                    "stored in 16? Full scale would be wrong by {:.0f}, saturated pixels count, "
                    "and told noise and light do not fit",
                    spec.camera, codes.largest, likely, std::exp2(16 - likely)),
        fmt::format("values times {:.0f} (shift left by {} bits)", std::exp2(16 - likely),
                    16 - likely));
  }
}

}  // namespace hookeye::inspection
