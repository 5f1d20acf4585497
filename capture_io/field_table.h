// A table of points with their displacements or strains, as programs for digital image correlation
// write it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "capture_io/field_columns.h"
#include "core/input_error.h"

namespace hookeye {

/// Numbers as the file has them, in its own frame.
struct FieldTable {
  Eigen::Matrix3Xd X, u;    ///< places and displacements; 0 where the file has no third one
  std::vector<int> lines;   ///< by point
  Eigen::Matrix3Xd strain;  ///< exx, eyy, exy as fractions; 0 where the file has none
  bool has_z = false, has_u = false, has_w = false, has_exy = false;
  std::string unit;         ///< "mm" | "px" ..., as the head of the columns tells; "": it does not
  std::string strain_unit;  ///< the same of strains
  std::string measure;      ///< of the strains, as the head tells; "": it does not
  std::string strain_columns;  ///< their names, whatever the field is read for; "": there are none
  /// Of rows without a number, or that the file marks as not correlated.
  std::vector<int> dropped_lines;
};

/// Text with a line of column names: CSV with comma, semicolon (then a decimal comma is a point) or
/// tab, or blanks; lines of `#` or `***` before it are passed over. Columns go by the names of
/// VIC-3D, MatchID (X Y Z U V W, a unit in brackets), DICe and pyvale, or by `columns`: kFieldRoles
/// (or "GXY") to the file's own name. `told`: the file's name in faults. Throws InputError with the
/// line: no such column, a cell that is no number, a row of another length, a point twice, no point
/// left. Of strains displacements are read where they are there, and may be not finite.
FieldTable read_field_table(const std::filesystem::path& file, const std::string& told,
                            const std::map<std::string, std::string>& columns = {},
                            FieldHolds holds = FieldHolds::displacements);

}  // namespace hookeye
