#include "estimation/model/parameters_json.h"

#include <algorithm>
#include <tuple>

namespace hookeye {

using nlohmann::json;

std::pair<double, double> interval_within(const Parameter& parameter, double low, double high) {
  return {std::max(low, parameter.low), std::min(high, parameter.high)};
}

json parameters_json(const std::vector<Parameter>& parameters, const Eigen::VectorXd& value,
                     const Eigen::VectorXd* low, const Eigen::VectorXd* high) {
  json all = json::array();
  for (size_t i = 0; i < parameters.size(); ++i) {
    json one = {{"name", parameters[i].name},
                {"unit", parameters[i].unit},
                {"long_name", parameters[i].long_name},
                {"value", value[i]}};
    if (low)
      std::tie(one["low"], one["high"]) = interval_within(parameters[i], (*low)[i], (*high)[i]);
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace hookeye
