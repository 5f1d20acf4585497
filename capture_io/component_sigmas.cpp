#include "capture_io/component_sigmas.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "capture_io/capture_reader.h"

namespace hookeye {

Eigen::VectorXd read_component_sigmas(const YamlNode& node, int components,
                                      const std::string& along) {
  if (node.kind != YamlNode::Kind::sequence)
    return Eigen::VectorXd::Constant(components, read_positive(node, "sigma"));
  const std::vector<double> all = read_numbers(node, "sigma");
  if (static_cast<int>(all.size()) != components)
    throw InputError(
        node.place, fmt::format("{} sigmas, but {} components ({})", all.size(), components, along),
        "one number for all, or one a component");
  for (const double one : all)
    if (!(one > 0.0))
      throw InputError(node.place, fmt::format("a sigma of {:g}", one), "numbers above zero");
  return Eigen::Map<const Eigen::VectorXd>(all.data(), components);
}

Eigen::VectorXd component_sigmas(const MeasuredSpec& measured) {
  return measured.sigma.head(measured.field->components) / std::sqrt(measured.field->alike[0]);
}

}  // namespace hookeye
