// Square tags on the body at known places: their corners in photos are pairs.
#pragma once

#include <filesystem>
#include <vector>

#include "core/input_error.h"
#include "placing/placing.h"

namespace hookeye {

struct BodyTag {
  int id = 0;
  double size = 0.0;     ///< side of the black square [length]
  Vector3d centre;       ///< in the body's frame [length]
  Vector3d right, down;  ///< along its sides, as one reads it; unit vectors
  Place place;           ///< where it was told

  /// Of the black square: upper left (0), then clockwise.
  Vector3d corner(int k) const;
};

/// A file with `ID SIZE  x y z of the centre  to the right  down` a line: eleven numbers, separated
/// by blanks, tabs, commas or semicolons; `#` begins a comment. Throws InputError: an id twice,
/// directions that are not at right angles within a degree.
std::vector<BodyTag> read_tags(const std::filesystem::path& file);

}  // namespace hookeye
