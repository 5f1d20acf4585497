#include "runs/report/met_values.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <map>
#include <vector>

#include "runs/tables.h"

namespace hookeye {

using nlohmann::json;

namespace {

std::string text_of(const json& object, const char* key) {
  return object.is_object() && object.contains(key) && object[key].is_string()
             ? object[key].get<std::string>()
             : "";
}

json items_of(const json& object, const char* key) {
  return object.is_object() && object.contains(key) && object[key].is_array() ? object[key]
                                                                              : json::array();
}

/// By how much a force is more than predicted; zero: it is none.
Eigen::Vector3d force_off(const json& one) {
  const json told = items_of(one, "measured"), predicted = items_of(one, "predicted");
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  if (text_of(one, "kind") != "force_on" || told.size() != 3 || predicted.size() != 3) return out;
  for (int i = 0; i < 3; ++i)
    if (told[i].is_number() && predicted[i].is_number())
      out[i] = told[i].get<double>() - predicted[i].get<double>();
  return out;
}

/// Of all supports of a load case together: what the body lacks does not ask which of them bears
/// it.
using ForcesOff = std::map<std::string, Eigen::Vector3d>;
ForcesOff forces_off(const json& metrics) {
  ForcesOff out;
  for (const json& one : items_of(metrics, "measured"))
    if (text_of(one, "kind") == "force_on")
      out.try_emplace(text_of(one, "example"), Eigen::Vector3d::Zero()).first->second +=
          force_off(one);
  return out;
}

/// How far two forces or weights may be apart and still be the same: a density, a volume or a
/// calibration is told to some per cent.
constexpr double kSame = 0.1;

/// As much in every load case where forces are measured.
bool alike(const ForcesOff& all) {
  if (all.size() < 2) return false;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& [example, off] : all) mean += off / static_cast<double>(all.size());
  if (mean.isZero(0.0)) return false;
  for (const auto& [example, off] : all)
    if ((off - mean).norm() > kSame * mean.norm()) return false;
  return true;
}

/// What a force that is far off in an example fits; "": nothing that is known here.
std::string fits(const json& metrics, const std::string& example) {
  // From the lightest rubbers to silicones full of minerals, over water.
  constexpr double kLightest = 0.8, kHeaviest = 2.5;
  const ForcesOff all = forces_off(metrics);
  const auto here = all.find(example);
  if (here == all.end()) return "";
  const json weight = metrics.value("weight", json());
  const double size = here->second.norm(), told = number_in(weight, "told");
  const double of_water = number_in(weight, "of_water");
  const std::string unit = text_of(weight, "unit"), lacks = ", and the model has no gravity";
  if (told > 0.0 && std::abs(size - told) <= kSame * told)
    return fmt::format(", by {:.3g} {}: the body weighs {:.3g} {} by its density{}", size, unit,
                       told, unit, lacks);
  if (!alike(all)) return "";
  const std::string as_all = fmt::format(", by {:.3g}{} as in all {} load cases", size,
                                         unit.empty() ? "" : " " + unit, all.size());
  if (const double times = of_water > 0.0 ? size / of_water : 0.0;
      told == 0.0 && times >= kLightest && times <= kHeaviest)
    return fmt::format("{}: the body weighs that at {:.4g} kg/m^3{}", as_all, 1000.0 * times,
                       lacks);
  return as_all + ": a zero that drifted, or a part of a weight that the model lacks";
}

}  // namespace

std::string met_values(const json& metrics) {
  constexpr double kFarOff = 5.0;  // by no noise
  double sum = 0.0, count = 0.0, worst = 0.0;
  std::string of, example, kind;
  for (const json& one : items_of(metrics, "measured"))
    for (const json& r : items_of(one, "over_sigma")) {
      if (!r.is_number()) continue;
      const double off = std::abs(r.get<double>());
      sum += off * off, count += 1.0;
      if (off <= worst) continue;
      worst = off;
      const std::string region = text_of(one, "region");
      kind = text_of(one, "kind"), example = text_of(one, "example");
      of = fmt::format("{}{} in '{}'", kind, region.empty() ? "" : " " + region, example);
    }
  if (count == 0.0) return "";
  std::string out =
      fmt::format("; measured values are met to {:.2g} of their sigma (RMS of {:.0f} components)",
                  std::sqrt(sum / count), count);
  if (worst <= kFarOff) return out;
  const std::string fit = kind == "force_on" ? fits(metrics, example) : "";
  return out + fmt::format(", {} is off by {:.2g}{}", of, worst,
                           fit.empty() ? ": look at its sign and its unit too" : fit);
}

}  // namespace hookeye
