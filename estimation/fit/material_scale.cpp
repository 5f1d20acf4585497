#include "estimation/fit/material_scale.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "capture_io/seen_in_words.h"
#include "estimation/evaluation/normal_equations.h"

namespace hookeye {
namespace {

/// "a, b and c".
std::string listed(const std::vector<std::string>& names) {
  if (names.size() < 2) return fmt::format("{}", fmt::join(names, ""));
  return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

bool prescribes_force(const ExampleSpec& example) {
  return std::any_of(example.loads.begin(), example.loads.end(), [](const LoadSpec& load) {
    return (load.force && !load.force->isZero(0.0)) || load.pressure.value_or(0.0) != 0.0;
  });
}

bool measures_force(const ExampleSpec& example) {
  return std::any_of(example.measured.begin(), example.measured.end(), is_reaction);
}

/// Share of what is known of the common scale of all moduli that measured forces tell, not photos
/// or fields.
double share_of_measured(const Evaluation& evaluation, const VectorXd& scale) {
  const Eigen::Index n = scale.size();
  double photos = 0.0, measured = 0.0;
  for (const auto& example : evaluation.examples) {
    if (example.held_out) continue;
    for (const auto& photo : example.photos)
      photos += scale.dot(photo.sums.JtJ.topLeftCorner(n, n) * scale);
    for (const auto& one : example.measured)
      (one.is_field() ? photos : measured) += (one.is_field() ? 1.0 : evaluation.measured_weight) *
                                              (one.J.leftCols(n) * scale).squaredNorm();
  }
  return photos + measured > 0.0 ? measured / (photos + measured) : 0.0;
}

std::string scale_sentence(const Scene& scene, const Fitted& fitted,
                           const std::vector<std::string>& moduli, double measured) {
  constexpr double kAlone = 0.95, kPart = 0.05;
  const Capture& capture = scene.capture;
  std::vector<std::string> prescribed, sensors, forces;
  forces.reserve(3);
  for (const ExampleSpec& example : capture.examples) {
    if (example.validate) continue;
    if (prescribes_force(example)) prescribed.push_back(example.name);
    if (measures_force(example)) sensors.push_back(example.name);
  }
  if (!prescribed.empty() && measured < kAlone)
    forces.push_back(fmt::format("the prescribed forces ({})", fmt::join(prescribed, ", ")));
  if (!sensors.empty() && measured > kPart)
    forces.push_back(fmt::format("the measured forces ({})", fmt::join(sensors, ", ")));
  if (capture.gravity && !capture.gravity->isZero(0.0) && measured < kAlone)
    forces.push_back("the weight as given (density and gravity)");
  const std::string named = listed(moduli), is = moduli.size() == 1 ? "is" : "are";
  const bool open = std::any_of(
      fitted.undetermined.begin(), fitted.undetermined.end(),
      [](const std::string& one) { return one.starts_with("stiffness scale not determined"); });
  if (open && !forces.empty())
    return fmt::format("the data fix only ratios of stiffness: the scale of {} is the capture's",
                       named);
  if (forces.empty())
    return fmt::format(
        "the {} fix only ratios of stiffness: no force is prescribed or measured, "
        "so the scale of {} is the capture's",
        seen_in_words(capture), named);
  return fmt::format("{} {} tied to {}: 1 % more force is 1 % more stiffness", named, is,
                     listed(forces));
}

}  // namespace

std::vector<std::string> what_fixes_the_scale(const Scene& scene, const Fitted& fitted) {
  const std::string stress = scene.capture.units.stress();
  VectorXd scale = VectorXd::Zero(fitted.p.size());
  std::vector<std::string> moduli;
  Eigen::Index i = 0;
  for (const auto& ingredient : fitted.form.ingredients)
    for (const Parameter& parameter : ingredient->parameters()) {
      const Eigen::Index own = i++;
      if (parameter.unit != stress) continue;
      scale[own] = fitted.p[own];
      if (ingredient->name() == "material") moduli.push_back(parameter.name);
    }
  if (scale.isZero(0.0)) return {"no modulus was fitted: the material is as the capture gives it"};
  if (moduli.empty() || moduli.size() > 4) moduli = {"the stiffness"};
  return {scale_sentence(scene, fitted, moduli, share_of_measured(fitted.evaluation, scale))};
}

}  // namespace hookeye
