#include "capture_io/strain_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "capture_io/component_sigmas.h"

namespace hookeye {

namespace {

StrainMeasure read_measure(const YamlNode& node, const FieldTable& table, const std::string& told) {
  const std::string word = read_string(node, "strain of the field");
  const std::string name = measure_called(word);
  const auto& known = strain_measures();
  const auto found = std::find(known.begin(), known.end(), name);
  if (found == known.end())
    throw InputError(
        node.place,
        name.empty() ? fmt::format("`{}` is no measure of strain that is known", word)
                     : fmt::format("{} strains are not read: their axes are those of "
                                   "the deformed body",
                                   name),
        fmt::format("one of {}: which, the program that computed them says{}",
                    fmt::join(known, ", "), name.empty() ? "" : "; export Lagrange or Hencky"));
  if (!table.measure.empty() && table.measure != name)
    throw InputError(node.place,
                     fmt::format("the head of {} says that its strains are {}, the capture {}",
                                 told, table.measure, name),
                     std::find(known.begin(), known.end(), table.measure) == known.end()
                         ? "export Lagrange or Hencky strains"
                         : fmt::format("`strain: {}`", table.measure));
  return static_cast<StrainMeasure>(found - known.begin());
}

Eigen::Matrix<double, 3, 2> read_axes(const YamlNode& node) {
  const std::string right = "write `axes: [[1, 0, 0], [0, 1, 0]]`: exx is along the first";
  const auto& rows = read_list(node, "axes of the strains", right);
  if (rows.size() != 2)
    throw InputError(node.place, fmt::format("{} axes of the strains", rows.size()), right);
  Eigen::Matrix<double, 3, 2> out;
  for (int i = 0; i < 2; ++i)
    out.col(i) = read_direction(rows[static_cast<size_t>(i)], "axis of the strains");
  if (std::abs(out.col(0).dot(out.col(1))) > 1e-3)
    throw InputError(node.place, "the axes of the strains are not at right angles", right);
  return out;
}

}  // namespace

double strain_scale(const YamlSection& section, const FieldTable& table, const std::string& told) {
  const YamlNode* node = section.find("strain_unit");
  if (!node) return 1.0;  // the head's, if any, is in the table already
  const std::string unit = node->kind == YamlNode::Kind::scalar ? node->text : "";
  const double out = fraction_in(unit);
  if (unit.empty() || out == 0.0)
    throw InputError(node->place, fmt::format("{} is no unit of strains", describe(*node)),
                     "one of fraction, percent, millistrain, microstrain");
  if (!table.strain_unit.empty() && fraction_in(table.strain_unit) != out)
    throw InputError(node->place,
                     fmt::format("{} tells its strains in [{}], the capture in {}", told,
                                 table.strain_unit, unit),
                     "remove `strain_unit`");
  return table.strain_unit.empty() ? out : 1.0;
}

std::shared_ptr<const StrainSpec> read_strain(const YamlSection& section, const FieldTable& table,
                                              const std::string& told, double length,
                                              const Eigen::Matrix3d& axes) {
  auto out = std::make_shared<StrainSpec>();
  out->measure = read_measure(section.need("strain", "write `strain: green`"), table, told);
  if (const YamlNode* gauge = section.find("gauge")) {
    out->gauge = read_not_negative(*gauge, "gauge");
    out->gauge_told = true;
  }
  out->axes = axes.leftCols<2>();
  if (const YamlNode* node = section.find("axes")) out->axes = read_axes(*node);
  out->sigma = read_component_sigmas(
      section.need("sigma", "give the standard deviation of a strain, a fraction: `sigma: 0.0002`"),
      table.has_exy ? 3 : 2, table.has_exy ? "exx, eyy, exy" : "exx, eyy");
  if (table.has_u) {
    out->u = axes * (length * table.u);
    out->u_components = table.has_w ? 3 : 2;
  }
  return out;
}

}  // namespace hookeye
