#include "estimation/model/parameters_json.h"

namespace hookeye {

using nlohmann::json;

json parameters_json(const std::vector<Parameter>& parameters, const Eigen::VectorXd& value,
                     const Eigen::VectorXd* low, const Eigen::VectorXd* high) {
  json all = json::array();
  for (size_t i = 0; i < parameters.size(); ++i) {
    json one = {{"name", parameters[i].name},
                {"unit", parameters[i].unit},
                {"long_name", parameters[i].long_name},
                {"value", value[i]}};
    if (low) one["low"] = (*low)[i], one["high"] = (*high)[i];
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace hookeye
