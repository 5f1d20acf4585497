// The residual that the effects of a diagnosis would remove, beside the residual there is.
#pragma once

#include <filesystem>

#include "estimation/search/discover.h"

namespace hookeye {

/// Whether a diagnosis has anything for write_removed().
bool has_pictures(const Diagnosis& diagnosis);

/// Renders the model after the linear step of every effect with EffectScore::displaced, each
/// example where the step takes it, with the photos' numbers that it gives. Writes into `folder`:
///   EFFECT/EXAMPLE-CAMERA.png  residual | what the effect would remove | what would be left,
///                              where it is EffectScore::pictured
///   EFFECT.json  for the page, by photo: cells of `cell_px` squared, `columns` by `rows`, two
///                bytes each (all first bytes, then all second ones, base64): root mean square
///                residual there is (from 1 on), and what the effect would remove of it (128:
///                nothing, more: removed), in `unit` standard deviations; 0: does not count
void write_removed(const std::filesystem::path& folder, const Step& step);

}  // namespace hookeye
