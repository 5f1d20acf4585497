// One picture a photo: photo, model, residual in units of noise on one fixed scale, and the
// residual displacement as arrows. The only file that draws (OpenCV).
#pragma once

#include <filesystem>

#include "estimation/evaluation/evaluation.h"

namespace hookeye {

/// Residuals are shown from -kResidualScale to +kResidualScale standard deviations of noise, in
/// every picture of every run, so that pictures can be compared.
constexpr double kResidualScale = 8.0;

/// `mm_per_px`: length units one pixel covers on the body (0: no length legend).
void write_compare_picture(const std::filesystem::path& png, const Image& photo,
                           const PhotoEvaluation& evaluation, const std::string& title,
                           double length_per_px, const std::string& length_unit);

/// Residual there is, what an effect would remove of it (the difference), and what would be left,
/// side by side on the same scale.
void write_removed_picture(const std::filesystem::path& png, const Image& residual,
                           const Image& left, const std::string& title, const std::string& effect);

/// The residual alone, same colours; transparent pixels do not count (drawn grey).
void write_residual_png(const std::filesystem::path& png, const Image& residual);

}  // namespace hookeye
