#include "capture_io/field_columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "capture_io/strain_field.h"

namespace hookeye {

namespace {

/// What a program calls places and displacements; "": it has none. Of two that fit a file the first
/// is taken.
struct Dialect {
  std::array<const char*, 6> names;
  const char* unit;
};
constexpr Dialect kDialects[] = {
    {{"X", "Y", "Z", "U", "V", "W"}, ""},  // VIC-3D, MatchID
    {{"MODEL_COORDINATES_X", "MODEL_COORDINATES_Y", "MODEL_COORDINATES_Z", "MODEL_DISPLACEMENT_X",
      "MODEL_DISPLACEMENT_Y", "MODEL_DISPLACEMENT_Z"},
     ""},  // DICe, stereo
    {{"COORDINATE_X", "COORDINATE_Y", "", "DISPLACEMENT_X", "DISPLACEMENT_Y", ""}, "px"},  // DICe
    {{"subset_x", "subset_y", "", "displacement_u", "displacement_v", ""}, "px"},          // pyvale
    {{"X", "Y", "Z", "Ux", "Uy", "Uz"}, ""},
    {{"x", "y", "z", "u", "v", "w"}, ""},
    {{"x", "y", "z", "ux", "uy", "uz"}, ""},
    {{"x_mm", "y_mm", "z_mm", "", "", ""}, "mm"},      // pyvale, strains of a stereo pair
    {{"window_x", "window_y", "", "", "", ""}, "px"},  // pyvale, strains
};

/// The same of strains. A shear `gamma` of DICe or VIC-3D is another thing and not here.
struct StrainDialect {
  std::array<const char*, 3> names;
  const char* measure;  ///< "": the program lets its user choose
};
constexpr StrainDialect kStrainDialects[] = {
    {{"exx", "eyy", "exy"}, ""},  // VIC-3D, and `export --to dic`
    {{"Exx", "Eyy", "Exy"}, ""},  // MatchID
    {{"VSG_STRAIN_XX", "VSG_STRAIN_YY", "VSG_STRAIN_XY"}, "green"},     // DICe
    {{"NLVC_STRAIN_XX", "NLVC_STRAIN_YY", "NLVC_STRAIN_XY"}, "green"},  // DICe
    {{"GREEN_LAGRANGE_STRAIN_XX", "GREEN_LAGRANGE_STRAIN_YY", "GREEN_LAGRANGE_STRAIN_XY"}, "green"},
    {{"eps_00", "eps_11", "eps_01"}, ""},  // pyvale
    {{"eps_xx", "eps_yy", "eps_xy"}, ""},
    {{"strain_xx", "strain_yy", "strain_xy"}, ""},
    {{"EXX", "EYY", "EXY"}, ""},
};
constexpr const char* kGammas[] = {"gxy", "Gxy", "GXY", "gamma_xy", "gammaxy"};

/// "Displacement.U [mm]" is the column U in mm, "exx [1] - Lagrange" exx by that measure.
struct Head {
  std::string name, unit, measure;
};

Head head_of(std::string_view cell) {
  Head out;
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    const size_t at = cell.find(open), end = cell.rfind(close);
    if (at == std::string_view::npos || end == std::string_view::npos || end < at) continue;
    out.unit = bare_cell(cell.substr(at + 1, end - at - 1));
    out.measure = measure_called(std::string(cell.substr(end + 1)));
    cell = bare_cell(cell.substr(0, at));
    break;
  }
  if (const size_t at = cell.rfind(" - "); out.measure.empty() && at != std::string_view::npos) {
    out.measure = measure_called(std::string(cell.substr(at)));
    if (!out.measure.empty()) cell = bare_cell(cell.substr(0, at));
  }
  if (const std::string measure = measure_called(out.unit); !measure.empty())
    out.measure = measure, out.unit.clear();
  for (const char* group :
       {"Coordinates.", "Displacement.", "coor.", "disp.", "strain.", "Horizontal Displacement ",
        "Vertical Displacement ", "Out-Of-Plane: ", "Strain-global frame: "})
    if (cell.starts_with(group)) cell.remove_prefix(std::string_view(group).size());
  out.name = cell;
  if (out.unit == "pixel" || out.unit == "pixels" || out.unit == "Pixel") out.unit = "px";
  return out;
}

int find(const std::vector<Head>& heads, std::string_view name) {
  if (name.empty()) return -1;
  for (size_t i = 0; i < heads.size(); ++i)
    if (heads[i].name == name) return static_cast<int>(i);
  return -1;
}

std::string listed(const std::vector<std::string_view>& cells) {
  std::vector<std::string> shown;
  for (size_t i = 0; i < std::min<size_t>(cells.size(), 20); ++i)
    shown.emplace_back(cells[i].substr(0, 40));
  return fmt::format("{}{}", fmt::join(shown, ", "), cells.size() > 20 ? ", ..." : "");
}

/// The head of a table while its columns are found.
struct Table {
  const std::vector<std::string_view>& cells;
  const Place& place;
  const std::map<std::string, std::string>& told;
  std::vector<Head> heads = {};

  /// By the name that the user gave, whole or without its unit.
  int named(const std::string& name) const {
    int out = find(heads, name);
    for (size_t i = 0; i < cells.size() && out < 0; ++i)
      if (cells[i] == name) out = static_cast<int>(i);
    if (out < 0)
      throw InputError(place, fmt::format("there is no column `{}`", name),
                       "the file has " + listed(cells));
    return out;
  }
  /// Whether the user named one of three roles.
  bool names_any(size_t first) const {
    return std::any_of(kFieldRoles.begin() + first, kFieldRoles.begin() + first + 3,
                       [&](const char* role) { return told.contains(role); }) ||
           (first == 6 && told.contains("GXY"));
  }
  /// Three roles by the names that the user gave; the others must be the roles' own.
  void by_told_names(size_t first, FieldColumns& out) const {
    for (size_t role = first; role < first + 3; ++role) {
      const auto of = told.find(kFieldRoles[role]);
      out.of_role[role] = of == told.end() ? find(heads, kFieldRoles[role]) : named(of->second);
    }
    if (const auto gamma = told.find("GXY"); first == 6 && gamma != told.end()) {
      if (told.contains("EXY"))
        throw InputError(place, "`columns` names both EXY and GXY", "one of them: GXY is 2 EXY");
      out.of_role[8] = named(gamma->second), out.gamma = true;
    }
  }
};

/// Places, and what of displacements the same program has.
void find_points(const Table& table, FieldHolds holds, FieldColumns& out) {
  const bool places = table.names_any(0), moves = table.names_any(3);
  if (places) table.by_told_names(0, out);
  if (moves) table.by_told_names(3, out);
  for (const Dialect& dialect : kDialects) {
    for (size_t role = 0; role < 6; ++role)
      if (!(role < 3 ? places : moves)) out.of_role[role] = find(table.heads, dialect.names[role]);
    if (!places) out.unit = dialect.unit;
    if (out.has(0) && out.has(1) && (holds == FieldHolds::strains || (out.has(3) && out.has(4))))
      return;
  }
}

void find_strains(const Table& table, FieldColumns& out) {
  if (table.names_any(6)) {
    table.by_told_names(6, out);
    return;
  }
  for (const StrainDialect& dialect : kStrainDialects) {
    for (size_t k = 0; k < 3; ++k) out.of_role[6 + k] = find(table.heads, dialect.names[k]);
    out.measure = dialect.measure;
    if (!out.has(6) && !out.has(7)) continue;
    for (const char* gamma : kGammas)
      if (!out.has(8) && (out.of_role[8] = find(table.heads, gamma)) >= 0) out.gamma = true;
    return;
  }
  out.of_role[8] = -1;
}

/// One unit of lengths; of displacements that nobody asks for, or none.
void take_units(const Table& table, FieldHolds holds, FieldColumns& out) {
  for (size_t role = 0; role < 6; ++role) {
    if (out.of_role[role] < 0) continue;
    const Head& head = table.heads[static_cast<size_t>(out.of_role[role])];
    if (head.unit.empty()) continue;
    if (!out.unit.empty() && out.unit != head.unit) {
      if (role >= 3 && holds == FieldHolds::strains) {
        out.of_role[3] = out.of_role[4] = out.of_role[5] = -1;
        return;
      }
      throw InputError(
          table.place,
          fmt::format("column `{}` is in {}, others in {}", head.name, head.unit, out.unit),
          "one unit for all of them");
    }
    out.unit = head.unit;
  }
}

void take_strain_units(const Table& table, FieldColumns& out) {
  std::string unit;
  for (size_t role = 6; role < 9; ++role) {
    if (out.of_role[role] < 0) continue;
    const Head& head = table.heads[static_cast<size_t>(out.of_role[role])];
    if (!head.measure.empty()) out.measure = head.measure;
    if (fraction_in(head.unit) == 0.0)
      throw InputError(table.place,
                       fmt::format("column `{}` is in `{}`, which is no unit of strains that is "
                                   "known",
                                   head.name, head.unit),
                       "[1], [%], [mm/m] or [um/m]; mstrain and ustrain are known too");
    if (role > 6 && fraction_in(head.unit) != out.fraction)
      throw InputError(table.place,
                       fmt::format("column `{}` is in `{}`, others in `{}`", head.name,
                                   head.unit.empty() ? "1" : head.unit, unit.empty() ? "1" : unit),
                       "one unit for all strains");
    unit = out.strain_unit = head.unit, out.fraction = fraction_in(head.unit);
  }
}

/// Pixels are not taken where the file has lengths but for one or two columns.
void refuse_partial(const Table& table) {
  for (const Dialect& dialect : kDialects) {
    if (*dialect.unit) continue;
    std::vector<std::string> there, missing;
    for (const char* name : dialect.names)
      (find(table.heads, name) >= 0 ? there : missing).push_back(name);
    if (there.size() < 4) continue;
    throw InputError(
        table.place,
        fmt::format("of {} the file lacks {}; it has {}", fmt::join(dialect.names, ", "),
                    fmt::join(missing, ", "), listed(table.cells)),
        "export all of them; or tell the file's own names: `columns: {X: NAME, Y: "
        "NAME, U: NAME, V: NAME}`");
  }
}

void refuse_missing(const Table& table, FieldHolds holds, const FieldColumns& out) {
  const bool points = out.has(0) && out.has(1);
  const bool moves = points && out.has(3) && out.has(4);
  if (holds == FieldHolds::displacements && table.told.empty() && (!moves || out.unit == "px"))
    refuse_partial(table);
  if (holds == FieldHolds::displacements && !moves)
    throw InputError(
        table.place,
        "the columns of points and displacements are not found in " + listed(table.cells),
        out.strains.empty()
            ? "X, Y, U, V and, where they are known, Z and W; or tell the file's own "
              "names: `columns: {X: NAME, Y: NAME, U: NAME, V: NAME}`"
            : fmt::format("its strains {} are read where the capture says by which "
                          "measure: `strain: green`",
                          out.strains));
  if (holds == FieldHolds::displacements) return;
  if (points && out.has(6) != out.has(7)) {
    const bool x = out.has(6);
    const Head& there = table.heads[static_cast<size_t>(out.of_role[x ? 6 : 7])];
    throw InputError(
        table.place,
        fmt::format("there is `{}`, but no strain along {}", there.name, x ? "y" : "x"),
        fmt::format("export both; or tell the other's name: `columns: {{{}: NAME}}`. "
                    "One gauge alone is `strain_of`",
                    x ? "EXX: " + there.name + ", EYY" : "EYY: " + there.name + ", EXX"));
  }
  if (!points || !out.has(6))
    throw InputError(table.place,
                     "the columns of points and strains are not found in " + listed(table.cells),
                     "X, Y, exx, eyy and, where they are known, Z and exy; or tell the file's own "
                     "names: `columns: {X: NAME, Y: NAME, EXX: NAME, EYY: NAME, EXY: NAME}`, with "
                     "GXY for 2 EXY");
}

}  // namespace

std::string_view bare_cell(std::string_view text) {
  const auto quiet = [](char c) { return std::isspace(static_cast<unsigned char>(c)) || c == '"'; };
  while (!text.empty() && quiet(text.front())) text.remove_prefix(1);
  while (!text.empty() && quiet(text.back())) text.remove_suffix(1);
  return text;
}

FieldColumns field_columns(const std::vector<std::string_view>& cells, const Place& place,
                           const std::map<std::string, std::string>& told, FieldHolds holds) {
  Table table{cells, place, told};
  for (const auto cell : cells) table.heads.push_back(head_of(cell));
  FieldColumns out;
  out.count = cells.size();
  find_points(table, holds, out);
  find_strains(table, out);
  std::vector<std::string> strains;
  for (size_t role = 6; role < 9; ++role)
    if (out.of_role[role] >= 0)
      strains.push_back(table.heads[static_cast<size_t>(out.of_role[role])].name);
  out.strains = fmt::format("{}", fmt::join(strains, ", "));
  refuse_missing(table, holds, out);
  if (holds == FieldHolds::strains)
    take_strain_units(table, out);
  else
    out.of_role[6] = out.of_role[7] = out.of_role[8] = -1;
  take_units(table, holds, out);
  for (const char* name : {"sigma", "SIGMA"})
    if (out.sigma < 0) out.sigma = find(table.heads, name);
  out.flag = find(table.heads, "STATUS_FLAG");
  out.converged = find(table.heads, "converged");
  return out;
}

}  // namespace hookeye
