// Small pictures of what is left, for docs/real-data.md: figures, no reproduced photos.
#pragma once

#include <filesystem>
#include <vector>

#include "estimation/output/compare_picture.h"

namespace hookeye::real {

/// Residual displacement cell by cell, horizontal beside vertical, blue -largest .. red +largest
/// [px]; white: none, grey: no cell. `cell` picture pixels a side.
void write_motion(const std::filesystem::path& png, const FlowField& flow, double largest_px,
                  int cell = 6);

/// Two silhouettes in one picture: white in both, red only in the photo, blue only in the model,
/// grey where the photo does not count. Half size.
void write_overlay(const std::filesystem::path& png, const Image& model, const Image& photo,
                   const std::vector<unsigned char>& valid);

/// Pictures of one height in a row, a gap between them.
Image side_by_side(const std::vector<Image>& pictures);

/// Residual in units of noise, blue -8 .. red +8 as `compare` has it, grey where a pixel does not
/// count. Half size.
Image residual_picture(const PhotoEvaluation& seen);

}  // namespace hookeye::real
