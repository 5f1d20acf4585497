#include "estimation/search/shadow.h"

#include <fmt/format.h>

#include <algorithm>

#include "estimation/effects/catalogue.h"
#include "estimation/search/contest.h"

namespace hookeye {

namespace {

/// What a finer mesh changes, worked out of this model once for all of its scene: it is the mesh's
/// and the loads', and effects change little of it.
std::shared_ptr<const Ingredient> finer_mesh(const Fitted& fitted) {
  const Model model = realised(fitted);
  for (const Effect* effect : catalogue())
    if (effect->group() == EffectGroup::numerical)
      for (auto& one : effect->candidates(model, nullptr)) return one;
  return nullptr;
}

/// The sums of a fitted model with the column of `mesh`; empty: there is no such equilibrium, or it
/// was cancelled. The workspace is left where it was.
std::optional<Evaluation> with_mesh(Workspace& workspace, const Fitted& fitted,
                                    const std::shared_ptr<const Ingredient>& mesh,
                                    const FitOptions& options) {
  EvaluationOptions evaluation;
  evaluation.registered = true;  // as the sums of a fit are
  evaluation.held_out = true;
  evaluation.measured_weight = fitted.evaluation.measured_weight;
  evaluation.most_iterations = options.most_iterations;
  evaluation.cancel = options.cancel;
  const Workspace::Place place = workspace.place();
  auto result = workspace.evaluate(fitted.form, fitted.p, evaluation, {mesh});
  workspace.start_from(place);
  if (result) return *std::move(result);
  return {};
}

}  // namespace

void Shadow::follow(const Step& step) {
  for (One& one : models_) one.of_this_step = false;
  floor_ = step.diagnosis.floor;
  scores_.clear();
  if (!prices_) prices_ = model_prices(step.fitted);
  if (mesh_scene_ != step.fitted.form.scene) {
    mesh_ = finer_mesh(step.fitted);
    mesh_scene_ = step.fitted.form.scene;
    const bool linear = mesh_scene_->body->mesh.order == 1;
    to_the_limit_ = 1.0 / (1.0 - (linear ? mesh_scene_->limits->diagnosis.order_change
                                         : kFinerEdge * kFinerEdge));
  }
  step_ = step.fitted;
  drop_pictures(*step_);
  const auto known = std::find_if(models_.begin(), models_.end(),
                                  [&](const One& one) { return &one == find(step.fitted); });
  if (known == models_.end())
    add(step.fitted, 0.0);
  else
    known->of_this_step = true;
}

void Shadow::refitted(const Fitted& fitted) {
  if (step_ && !find(fitted)) add(fitted, score_above(fitted, *step_, floor_));
}

void Shadow::add(const Fitted& fitted, double old) {
  std::optional<Evaluation> sums;
  if (mesh_ && fitted.form.scene == mesh_scene_)
    sums = with_mesh(workspace_, fitted, mesh_, options_);
  if (options_.cancel && *options_.cancel) return;
  scores_.clear();
  models_.push_back({scored_model(fitted, *prices_, sums ? &*sums : nullptr, to_the_limit_),
                     fitted.p, old, true});
}

const Shadow::One* Shadow::find(const Fitted& fitted) const {
  const std::string words = effects_in_words(fitted.form);
  for (const One& one : models_)
    if (one.model.words == words && one.p == fitted.p) return &one;
  return nullptr;
}

const std::vector<ModelScore>& Shadow::scores() const {
  if (models_.empty() || !scores_.empty()) return scores_;
  const auto reference =
      std::min_element(models_.begin(), models_.end(),
                       [](const One& a, const One& b) { return a.model.misfit < b.model.misfit; });
  const ResidualNoise noise = estimate_noise(reference->model.seen, floor_);
  for (const One& one : models_) scores_.push_back(score(one.model, noise));
  return scores_;
}

std::optional<double> Shadow::below_best(const Fitted& fitted) const {
  const One* known = find(fitted);
  if (!known) return {};
  const auto& all = scores();
  double best = all.front().total();
  for (const ModelScore& one : all) best = std::max(best, one.total());
  return all[static_cast<size_t>(known - models_.data())].total() - best;
}

void Shadow::tell_all(const Decided& decided) const {
  if (!decided || models_.empty()) return;
  const auto& all = scores();
  std::vector<double> totals;
  for (const ModelScore& one : all) totals.push_back(one.total());
  const std::vector<double> sure = posterior(totals);
  const double best = *std::max_element(totals.begin(), totals.end());
  for (size_t i = 0; i < models_.size(); ++i) {
    const One& one = models_[i];
    const ModelScore& of = all[i];
    if (!one.of_this_step && of.total() < best) continue;
    Decision decision{Asked::scored,
                      one.model.words,
                      of.total() == best,
                      {of.total(), of.ceiling, "floor.chance"},
                      "log evidence of fitted and of held-out data and prior; decides nothing yet"};
    decision.parts = {{"fitted", of.fitted}, {"held_out", of.held_out},
                      {"prior", of.prior},   {"below_best", of.total() - best},
                      {"sure", sure[i]},     {"old", one.old}};
    tell(decided, std::move(decision));
  }
}

}  // namespace hookeye
