// Photos of a synthetic truth by another renderer. Internal to synth.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "estimation/synth/synth_truth.h"

namespace hookeye::detail {

/// Pictures of all examples by all cameras, [example][photo], linear, before noise.
using Pictures = std::vector<std::vector<Image>>;

/// Writes what stands before the cameras into `stage` (scene.json and one surface per example:
/// docs/synth.md, "Another photographer"), runs `command stage` and reads the pictures it left
/// there. Gain and defocus are applied here. Throws InputError when the command fails, leaves a
/// picture out or one of another size, or cannot know what the truth holds (gloss).
Pictures photographed_by(const std::string& command, const Truth& truth,
                         const std::filesystem::path& albedo, const std::filesystem::path& stage);

}  // namespace hookeye::detail
