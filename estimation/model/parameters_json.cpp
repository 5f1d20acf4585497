#include "estimation/model/parameters_json.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace hookeye {

using nlohmann::json;

std::pair<double, double> interval_within(const Parameter& parameter, double low, double high) {
  return {std::max(low, parameter.low), std::min(high, parameter.high)};
}

bool centre_is_unknown(const Parameter& parameter, double low, double high) {
  constexpr double kAnywhere = 0.5;  // of the body: of a place that may be anywhere it is 0.95
  const double body = parameter.high - parameter.low;
  std::tie(low, high) = interval_within(parameter, low, high);
  return parameter.long_name.starts_with("centre of the ") && std::isfinite(body) &&
         high - low > kAnywhere * body;
}

json parameters_json(const std::vector<Parameter>& parameters, const Eigen::VectorXd& value,
                     const Eigen::VectorXd* low, const Eigen::VectorXd* high) {
  json all = json::array();
  for (size_t i = 0; i < parameters.size(); ++i) {
    json one = {{"name", parameters[i].name},
                {"unit", parameters[i].unit},
                {"long_name", parameters[i].long_name},
                {"value", value[i]}};
    const auto at = static_cast<Eigen::Index>(i);
    if (low)
      std::tie(one["low"], one["high"]) = interval_within(parameters[i], (*low)[at], (*high)[at]);
    if (low && centre_is_unknown(parameters[i], (*low)[at], (*high)[at])) one["known"] = "open";
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace hookeye
