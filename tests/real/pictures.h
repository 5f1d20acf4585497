// Small pictures of what is left, for docs/real-data.md: figures, no reproduced photos.
#pragma once

#include <filesystem>

#include "estimation/flow.h"

namespace hookeye::real {

/// Residual displacement cell by cell, horizontal beside vertical, blue -largest .. red +largest
/// [px]; white: none, grey: no cell. `cell` picture pixels a side.
void write_motion(const std::filesystem::path& png, const FlowField& flow, double largest_px,
                  int cell = 6);

/// Two silhouettes in one picture: white in both, red only in the photo, blue only in the model,
/// grey where the photo does not count. Half size.
void write_overlay(const std::filesystem::path& png, const Image& model, const Image& photo,
                   const std::vector<unsigned char>& valid);

}  // namespace hookeye::real
