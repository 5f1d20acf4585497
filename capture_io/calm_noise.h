// Noise of a photo that texture fills, from its calmest spots. Used by estimate_noise().
#pragma once

#include <optional>

#include "capture_io/image.h"

namespace hookeye {

/// Empty where the photo is too small, or holds no calm spots over half its range of intensity.
std::optional<NoiseModel> calm_noise(const Image& image);

}  // namespace hookeye
