// Standard deviations of what a field holds, by component.
#pragma once

#include <Eigen/Core>
#include <string>

#include "capture_io/capture.h"
#include "capture_io/yaml_file.h"

namespace hookeye {

/// One number for all of `components`, or one each; `along` names them, "x, y, z". Throws
/// InputError.
Eigen::VectorXd read_component_sigmas(const YamlNode& node, int components,
                                      const std::string& along);

/// Those of a measured field, as they were told.
Eigen::VectorXd component_sigmas(const MeasuredSpec& measured);

}  // namespace hookeye
