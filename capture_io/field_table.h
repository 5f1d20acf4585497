// A table of points and their displacements, as programs for digital image correlation write it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/input_error.h"

namespace hookeye {

/// Numbers as the file has them, in its own frame.
struct FieldTable {
  Eigen::Matrix3Xd X, u;   ///< places and displacements; 0 where the file has no third one
  std::vector<int> lines;  ///< by point
  bool has_z = false, has_w = false;
  std::string unit;  ///< "mm" | "px" ..., as the head of the columns tells; "": it does not
  int dropped = 0;   ///< rows without a number, or that the file marks as not correlated
};

/// Text with a line of column names: CSV with comma, semicolon (then a decimal comma is a point) or
/// tab, or blanks; lines of `#` or `***` before it are passed over. Columns go by the names of
/// VIC-3D, MatchID (X Y Z U V W, a unit in brackets), DICe and pyvale, or by `columns`: "X", "Y",
/// "Z", "U", "V", "W" to the file's own name. `told`: the file's name in faults. Throws InputError
/// with the line: no such column, a cell that is no number, a row of another length, no point left.
FieldTable read_field_table(const std::filesystem::path& file, const std::string& told,
                            const std::map<std::string, std::string>& columns = {});

}  // namespace hookeye
