#include "estimation/effect_prediction.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "estimation/page_data.h"

namespace hookeye {

using nlohmann::json;

namespace {

/// The form with the scored effect, at the diagnosis' step. Bounds hold.
std::pair<ModelForm, VectorXd> stepped(const Fitted& fitted, const EffectScore& score) {
  ModelForm form = fitted.form;
  form.ingredients.push_back(score.best);
  VectorXd p(fitted.p.size() + score.values.size());
  p.head(fitted.p.size()) = fitted.p;
  if (score.base_step.size() == fitted.p.size()) p.head(fitted.p.size()) += score.base_step;
  p.tail(score.values.size()) = score.values;
  const auto parameters = form.parameters();
  for (size_t i = 0; i < parameters.size(); ++i)
    p[i] = std::clamp(p[i], parameters[i].low, parameters[i].high);
  return {std::move(form), std::move(p)};
}

double rms(const FlowCell& cell) { return std::sqrt(cell.r2 / std::max(cell.pixels, 1)); }

json cells_json(const FlowField& now, const FlowField& then) {
  std::map<std::pair<int, int>, double> with_effect;
  for (const FlowCell& cell : then.cells) with_effect[{cell.column, cell.row}] = rms(cell);
  std::vector<float> values;
  for (const FlowCell& cell : now.cells) {
    const auto found = with_effect.find({cell.column, cell.row});
    if (found == with_effect.end()) continue;
    for (const double v : {double(cell.column), double(cell.row), rms(cell), found->second})
      values.push_back(static_cast<float>(v));
  }
  return {{"components", 4}, {"float32", base64(values.data(), sizeof(float) * values.size())}};
}

}  // namespace

std::variant<json, NumericalFailure> predict_effect(Workspace& workspace, const Fitted& fitted,
                                                    const EffectScore& score,
                                                    const std::atomic<bool>* cancel) {
  const auto [form, p] = stepped(fitted, score);
  EvaluationOptions options;
  options.derivatives = false;
  options.pictures = options.held_out = true;
  options.cancel = cancel;
  auto evaluated = workspace.evaluate(form, p, options);
  if (auto* failure = std::get_if<NumericalFailure>(&evaluated)) return *failure;
  const Evaluation& then = std::get<Evaluation>(evaluated);
  json photos = json::object();
  int cell_px = 16;
  for (const auto& example : fitted.evaluation.examples) {
    const ExampleEvaluation* other = then.find(example.example);
    if (!other) continue;
    for (size_t k = 0; k < std::min(example.photos.size(), other->photos.size()); ++k) {
      cell_px = example.photos[k].flow.cell_px;
      photos[photo_name(workspace.scene(), example.photos[k])] = {
          {"cells", cells_json(example.photos[k].flow, other->photos[k].flow)}};
    }
  }
  return json{{"cell_px", cell_px}, {"photos", std::move(photos)}};
}

}  // namespace hookeye
