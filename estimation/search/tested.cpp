#include "estimation/search/tested.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include "estimation/effects/catalogue.h"

namespace hookeye {

namespace {

Tested::Example tested_example(const ExampleEvaluation& seen, const ExampleSpec& spec,
                               double* r2_of_all, double* count_of_all) {
  Tested::Example out{spec.name};
  double r2 = 0.0, count = 0.0;
  for (const PhotoEvaluation& photo : seen.photos) r2 += photo.r2, count += photo.count;
  for (const auto& measured : seen.measured) {
    if (!measured.is_field())
      out.measured = std::max(out.measured, measured.r.norm());
    else if (seen.photos.empty())
      r2 += measured.r.squaredNorm(), count += measured.size();
  }
  if (count > 0.0) out.chi = std::sqrt(r2 / count);
  *r2_of_all += r2, *count_of_all += count;
  return out;
}

}  // namespace

Result<std::optional<Tested>> test(const Fitted& fitted, const Capture& whole,
                                   const FitOptions& options) {
  const auto scene = with_tests(*fitted.form.scene, whole);
  const auto& examples = scene->capture.examples;
  const size_t own = fitted.form.scene->capture.examples.size();
  if (examples.size() == own) return std::nullopt;
  ModelForm form;
  VectorXd start;
  try {
    std::tie(form, start) = transfer(realised(fitted), scene, catalogue());
  } catch (const std::runtime_error& error) {
    return no_result({examples[own].name, 0.0, error.what()});
  }
  Workspace workspace(scene);
  auto settled = settle_held_out(workspace, form, start, options);
  if (!settled) return failure_of(settled);
  EvaluationOptions pictures = only_pictures(0, options);
  for (size_t e = own; e < examples.size(); ++e) pictures.only.push_back(static_cast<int>(e));
  const auto seen = workspace.evaluate(form, *settled, pictures);
  if (!seen) return failure_of(seen);
  Tested out;
  double r2 = 0.0, count = 0.0;
  for (const auto& example : seen->examples)
    if (example.example >= static_cast<int>(own))
      out.examples.push_back(tested_example(example, examples[example.example], &r2, &count));
  if (count > 0.0) out.chi = std::sqrt(r2 / count);
  return out;
}

nlohmann::json to_json(const Tested& tested) {
  nlohmann::json examples = nlohmann::json::array();
  for (const Tested::Example& one : tested.examples)
    examples.push_back({{"name", one.name},
                        {"chi", one.chi > 0.0 ? nlohmann::json(one.chi) : nlohmann::json()},
                        {"measured_over_sigma",
                         one.measured > 0.0 ? nlohmann::json(one.measured) : nlohmann::json()}});
  return {{"chi", tested.chi > 0.0 ? nlohmann::json(tested.chi) : nlohmann::json()},
          {"examples", std::move(examples)}};
}

}  // namespace hookeye
