// Which columns of a table hold what, by the names that programs for image correlation give them.
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/input_error.h"

namespace hookeye {

/// What a field is read for.
enum class FieldHolds { displacements, strains };

/// The roles of columns, as `columns` of a capture names them. GXY beside them: 2 EXY.
constexpr std::array<const char*, 9> kFieldRoles{"X", "Y", "Z", "U", "V", "W", "EXX", "EYY", "EXY"};

/// Where the columns stand; -1: the file has none.
struct FieldColumns {
  std::array<int, 9> of_role{-1, -1, -1, -1, -1, -1, -1, -1, -1};
  int sigma = -1;           ///< below zero: not correlated (VIC-3D, DICe)
  int flag = -1;            ///< the same (DICe)
  int converged = -1;       ///< zero: not correlated (pyvale)
  std::string unit;         ///< of lengths
  std::string measure;      ///< of strains, as strain_field.h names it; "": the head does not tell
  std::string strain_unit;  ///< of strains, as the head has it; "": it does not tell
  double fraction = 1.0;    ///< one of it
  bool gamma = false;       ///< the shear is twice exy
  std::string strains;      ///< names of the strains' columns, for messages; "": there are none
  size_t count = 0;

  bool has(int role) const { return of_role[static_cast<size_t>(role)] >= 0; }
};

/// `told`: role to the file's own name. Throws InputError at `place`, the line of the head.
FieldColumns field_columns(const std::vector<std::string_view>& cells, const Place& place,
                           const std::map<std::string, std::string>& told, FieldHolds holds);

/// Without blanks and quotes about it.
std::string_view bare_cell(std::string_view text);

}  // namespace hookeye
