// The residual that the leading effects of a diagnosis would remove, beside the residual there is.
#pragma once

#include <filesystem>

#include "estimation/discover.h"

namespace hookeye {

/// Pictures of the model after an effect's linear step: every photo of an example rendered where
/// the step takes it, with the photos' numbers that it gives. Residuals as PhotoEvaluation's; order
/// of `fitted.evaluation`. Empty for an effect without EffectScore::displaced.
std::vector<PhotoEvaluation> predicted_residuals(const Fitted& fitted, const EffectScore& score);

/// Whether a diagnosis has anything for write_removed().
bool has_pictures(const Diagnosis& diagnosis);

/// Writes into `folder`, for every effect with pictures:
///   EFFECT/EXAMPLE-CAMERA.png  residual | what the effect would remove | what would be left
///   EFFECT.json  for the page, by photo: cells of `cell_px` squared, `columns` by `rows`, two
///   bytes
///                each (all first bytes, then all second ones, base64): root mean square residual
///                there is, and what the effect would remove of it (128: nothing, more: removed),
///                in sixteenths of a standard deviation; 0: does not count
void write_removed(const std::filesystem::path& folder, const Step& step);

}  // namespace hookeye
