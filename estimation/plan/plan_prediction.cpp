#include "estimation/plan/plan_prediction.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <tuple>

#include "estimation/effects/catalogue.h"
#include "estimation/plan/planned_scene.h"

namespace hookeye {

namespace {

PlanHypothesis hypothesis_of(const EffectScore& score, const Model& model) {
  PlanHypothesis out;
  out.name = score.effect;
  if (score.best)
    out.ingredient = find_effect(score.effect)->candidate(model, score.best->variant());
  if (!out.ingredient) throw std::runtime_error(score.effect + " has no estimate in the diagnosis");
  std::map<std::string, double> value;
  const auto scored = score.best->parameters(), here = out.ingredient->parameters();
  for (size_t i = 0; i < scored.size(); ++i) value[scored[i].name] = score.values[i];
  out.step = VectorXd::Zero(static_cast<Eigen::Index>(here.size()));
  out.typical = out.step;
  for (size_t i = 0; i < here.size(); ++i) {
    if (value.count(here[i].name)) out.step[i] = value[here[i].name] - here[i].value;
    out.typical[i] = here[i].positive ? std::abs(here[i].value) : here[i].typical;
  }
  out.one_sided = here.size() == 1 && here[0].low >= here[0].value;
  return out;
}

/// Columns by the names of what they belong to.
std::vector<std::string> column_names(const ModelForm& form) {
  std::vector<std::string> names;
  for (const auto& ingredient : form.ingredients)
    for (const auto& parameter : ingredient->parameters())
      names.push_back(ingredient->name() + "/" + parameter.name);
  return names;
}

/// The fitted model without its numerical effects: what they change is little beside what is
/// planned, and each new load would have to be solved on another mesh too.
Model without_numerical(Model model) {
  std::erase_if(model.applied, [](const auto& one) { return numerical(one.first->name()); });
  return model;
}

/// The fitted model on a planned scene, with the effects appended as hypotheses at their nulls.
PlannedModel planned_model(const Model& now, std::shared_ptr<const Scene> scene,
                           const Diagnosis& diagnosis, const std::vector<std::string>& names,
                           std::vector<PlanHypothesis>* hypotheses) {
  PlannedModel out;
  std::tie(out.form, out.p) = transfer(now, std::move(scene), catalogue());
  out.model = out.form.realise(out.p);
  for (const auto& name : names) {
    const auto score = std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(),
                                    [&](const auto& one) { return one.effect == name; });
    if (score == diagnosis.effects.end())
      throw std::runtime_error(name + " is not in the diagnosis");
    PlanHypothesis one = hypothesis_of(*score, out.model);
    one.first = static_cast<int>(out.p.size());
    out.form.ingredients.push_back(one.ingredient);
    out.p.conservativeResize(one.first + one.step.size());
    const auto parameters = one.ingredient->parameters();
    for (size_t i = 0; i < parameters.size(); ++i)
      out.p[one.first + static_cast<int>(i)] = parameters[i].value;
    if (hypotheses) hypotheses->push_back(std::move(one));
  }
  return out;
}

std::vector<std::shared_ptr<const Ingredient>> hypotheses_of(const PlannedModel& planned,
                                                             size_t count) {
  const auto& all = planned.form.ingredients;
  return {all.end() - static_cast<std::ptrdiff_t>(count), all.end()};
}

/// The fitted part of the form alone.
std::pair<ModelForm, VectorXd> fitted_part(const PlannedModel& planned, size_t count) {
  ModelForm form = planned.form;
  form.ingredients.resize(form.ingredients.size() - count);
  return {form, planned.p.head(form.size())};
}

/// What a photo brings: the share of its sums that counts beside correlated residuals, and how many
/// effective residuals a pixel is. Cells are tens of pixels.
struct Share {
  double of_sums = 0.0, per_pixel = 0.0;
};

/// Means over the photos of a camera, and over all.
struct Shares {
  struct Sum {
    Share total;
    double photos = 0.0;
  };
  std::map<std::string, Sum> by_camera;
  Sum all;
  void add(const std::string& camera, const Share& share) {
    for (Sum* sum : {&by_camera[camera], &all}) {
      sum->total.of_sums += share.of_sums, sum->total.per_pixel += share.per_pixel;
      sum->photos += 1.0;
    }
  }
  Share of(const std::string& camera) const {
    const auto found = by_camera.find(camera);
    const Sum& sum = found == by_camera.end() ? all : found->second;
    const double n = std::max(sum.photos, 1.0);
    return {sum.total.of_sums / n, sum.total.per_pixel / n};
  }
};

/// Sums of the photos there are; the shares of what is correlated in them.
Shares sum_present(const Scene& scene, const ViewPhotos& of_photo, const Evaluation& evaluation,
                   Prediction& out) {
  Shares shares;
  out.H = Eigen::MatrixXd::Zero(evaluation.columns, evaluation.columns);
  for (const auto& example : evaluation.examples) {
    const auto& photos = scene.capture.examples[example.example].photos;
    const auto statistics = photo_statistics(example.photos);
    for (size_t k = 0; k < example.photos.size(); ++k) {
      const auto& photo = example.photos[k];
      if (of_photo.count({example.example, photo.photo})) continue;
      const FlowStatistics& flow = statistics[k];
      if (flow.count == 0.0) continue;
      const double w = flow.effective / flow.count;
      shares.add(photos[photo.photo].camera, {w, flow.effective / std::max(photo.count, 1.0)});
      out.H += w * photo.sums.JtJ;
      out.count += flow.effective;
    }
    for (const auto& measured : example.measured) {
      out.H += measured.J.transpose() * measured.J;
      out.count += measured.size();
    }
  }
  return shares;
}

void add_view(const PhotoEvaluation& photo, const Share& share, PredictedPhotos& to) {
  if (photo.count == 0.0) return;
  if (to.H.size() == 0) to.H = Eigen::MatrixXd::Zero(photo.sums.JtJ.rows(), photo.sums.JtJ.cols());
  to.H += share.of_sums * photo.sums.JtJ;
  to.count += share.per_pixel * photo.count;
  to.views.push_back({photo.example, photo.photo, photo.count, photo.sums.JtJ});
}

/// What stays the same over the candidates.
struct Planner {
  const Fitted& fitted;
  const Diagnosis& diagnosis;
  const PlanOptions& options;
  const Model now;                   ///< `applied` without numerical effects
  std::vector<std::string> names;    ///< of the hypotheses, confused ones first
  size_t confused = 0;               ///< so many of them
  std::vector<std::string> columns;  ///< of Prediction::H
  Shares shares;
};

void keep_states(const Evaluation& evaluation, PlannedModel& planned) {
  for (const auto& example : evaluation.examples)
    planned.states[example.example] = {example.equilibrium->q, example.S};
}

/// The photos there are and, in one look, those of all views.
Result<void> predict_views(Planner& planner, Prediction& out) {
  std::vector<PlanCandidate> candidates;
  for (const auto& one : out.photos) candidates.push_back(one.candidate);
  ViewPhotos of_photo;
  auto scene = with_views(*planner.fitted.form.scene, candidates, of_photo);
  std::vector<PlanHypothesis> all;
  auto planned = std::make_shared<PlannedModel>(
      planned_model(planner.now, scene, planner.diagnosis, planner.names, &all));
  planner.columns = column_names(planned->form);
  for (size_t i = 0; i < planner.columns.size(); ++i)
    planned->global.push_back(static_cast<int>(i));
  for (size_t i = 0; i < all.size(); ++i)
    (i < planner.confused ? out.confused : out.untestable).push_back(std::move(all[i]));
  std::map<int, VectorXd> states;
  for (const auto& example : planner.fitted.evaluation.examples)
    states[example.example] = example.equilibrium->q;
  take_photos(*scene, *planner.fitted.form.scene, planned->model, states);
  EvaluationOptions evaluation;
  evaluation.only = fitted_examples(*planner.fitted.form.scene);
  evaluation.pictures = true;  // the photos that there are tell how far misfits are correlated
  evaluation.cancel = planner.options.cancel;
  Workspace workspace(scene);
  const auto [form, p] = fitted_part(*planned, planner.names.size());
  auto result =
      workspace.evaluate(form, p, evaluation, hypotheses_of(*planned, planner.names.size()));
  if (!result) return failure_of(result);
  const Evaluation& seen = *result;
  keep_states(seen, *planned);
  out.base = form.size();
  planner.shares = sum_present(*scene, of_photo, seen, out);
  for (const auto& example : seen.examples)
    for (const auto& photo : example.photos) {
      const auto view = of_photo.find({example.example, photo.photo});
      if (view == of_photo.end()) continue;
      PredictedPhotos& to = out.photos[view->second];
      to.planned = planned;
      add_view(photo, planner.shares.of(to.candidate.view.name), to);
    }
  return {};
}

/// H over the columns of all, from that over the columns here.
Eigen::MatrixXd spread(const Eigen::MatrixXd& H, const std::vector<int>& global, int columns) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(columns, columns);
  for (int i = 0; i < H.rows(); ++i)
    for (int j = 0; j < H.cols(); ++j)
      if (global[i] >= 0 && global[j] >= 0) out(global[i], global[j]) += H(i, j);
  return out;
}

/// Newton iterations for a further load; there are other loads for one that folds or buckles.
constexpr int kMostIterations = 100;

/// One further load, photographed by the cameras there are.
void predict_load(const Planner& planner, PredictedPhotos& out) {
  auto scene = with_load(*planner.fitted.form.scene, out.candidate);
  const int e = static_cast<int>(scene->capture.examples.size()) - 1;
  auto planned = std::make_shared<PlannedModel>(
      planned_model(planner.now, scene, planner.diagnosis, planner.names, nullptr));
  for (const auto& name : column_names(planned->form)) {
    const auto at = std::find(planner.columns.begin(), planner.columns.end(), name);
    planned->global.push_back(
        at == planner.columns.end() ? -1 : static_cast<int>(at - planner.columns.begin()));
  }
  Workspace workspace(scene);
  const auto [form, p] = fitted_part(*planned, planner.names.size());
  EvaluationOptions evaluation;
  evaluation.only = {e};
  evaluation.derivatives = false;
  evaluation.most_iterations = kMostIterations;
  evaluation.cancel = planner.options.cancel;
  auto solved = workspace.evaluate(form, p, evaluation);
  if (!solved) {
    out.why_not =
        fmt::format("no equilibrium beyond {:.2g} of the load", solved.error().load_fraction);
    return;
  }
  std::map<int, VectorXd> states;
  for (const auto& example : planner.fitted.evaluation.examples)
    states[example.example] = example.equilibrium->q;
  states[e] = solved->find(e)->equilibrium->q;
  take_photos(*scene, *planner.fitted.form.scene, planned->model, states);
  evaluation.derivatives = true;
  auto result =
      workspace.evaluate(form, p, evaluation, hypotheses_of(*planned, planner.names.size()));
  if (!result) {
    out.why_not = "not evaluated";
    return;
  }
  keep_states(*result, *planned);
  const auto& example = result->examples.front();
  const int columns = static_cast<int>(planner.columns.size());
  for (auto photo : example.photos) {
    photo.sums.JtJ = spread(photo.sums.JtJ, planned->global, columns);
    add_view(photo, planner.shares.of(scene->capture.examples[e].photos[photo.photo].camera), out);
  }
  for (const auto& measured : example.measured) {
    out.H += spread(measured.J.transpose() * measured.J, planned->global, columns);
    out.count += measured.size();
  }
  out.planned = planned;
}

}  // namespace

Result<Prediction> predict(const Fitted& fitted, const Diagnosis& diagnosis,
                           const std::vector<std::string>& confused,
                           const std::vector<std::string>& untestable, const PlanOptions& options) {
  Planner planner{
      fitted,   diagnosis,       options, without_numerical(fitted.form.realise(fitted.p)),
      confused, confused.size(), {},      {}};
  planner.names.insert(planner.names.end(), untestable.begin(), untestable.end());
  Prediction out;
  out.noise = diagnosis.floor.cell_variance;
  std::vector<size_t> loads;
  for (const auto& candidate : plan_candidates(planner.now, options.grid_too)) {
    if (candidate.kind == PlanCandidate::Kind::load) loads.push_back(out.photos.size());
    out.photos.emplace_back();
    out.photos.back().candidate = candidate;
  }
  if (auto done = predict_views(planner, out); !done) return failure_of(done);
  for (auto& one : out.photos)
    if (one.H.size() == 0) one.H = Eigen::MatrixXd::Zero(out.H.rows(), out.H.cols());
  std::mutex mutex;
  int done = 1;
  auto report = [&](int finished) {
    if (options.progress) options.progress(finished, static_cast<int>(loads.size()) + 1);
  };
  report(done);
  tbb::parallel_for(size_t{0}, loads.size(), [&](size_t i) {
    if (options.cancel && options.cancel->load()) return;
    predict_load(planner, out.photos[loads[i]]);
    const std::lock_guard lock(mutex);
    report(++done);
  });
  if (options.cancel && options.cancel->load()) return stopped();
  for (auto& one : out.photos)
    if (one.why_not.empty() && one.views.empty()) one.why_not = "no camera would see the body";
  return out;
}

Difference difference_of(const PredictedPhotos& photos, const VectorXd& step) {
  const PlannedModel& planned = *photos.planned;
  const Scene& scene = *planned.model.scene;
  const RenderSurface& surface = scene.body->surface;
  VectorXd own = VectorXd::Zero(planned.p.size());
  for (int i = 0; i < own.size(); ++i)
    if (planned.global[i] >= 0) own[i] = step[planned.global[i]];
  const Model moved = planned.form.realise(planned.p + own);
  Difference out;
  double sum = 0.0, points = 0.0, r2 = 0.0, pixels = 0.0, largest = -1.0;
  for (const auto& view : photos.views) {
    const auto& [q, S] = planned.states.at(view.example);
    const Matrix3Xd x = surface.deformed(scene.body->mesh, q);
    const Matrix3Xd y = surface.deformed(scene.body->mesh, q + S * own);
    const Camera& from = planned.model.examples[view.example].photos[view.photo].camera;
    const Camera& to = moved.examples[view.example].photos[view.photo].camera;
    double here = 0.0, seen = 0.0;
    for (int v = 0; v < x.cols(); ++v) {
      const Eigen::Vector2d a = from.project(x.col(v)), b = to.project(y.col(v));
      if (!a.allFinite() || !b.allFinite() || a.x() < 0 || a.y() < 0 || a.x() > from.width - 1 ||
          a.y() > from.height - 1)
        continue;
      here += (b - a).squaredNorm();
      seen += 1.0;
    }
    const auto& spec = scene.capture.examples[view.example];
    if (seen > 0.0 && here / seen > largest) {
      largest = here / seen;
      out.most = photos.candidate.kind == PlanCandidate::Kind::load ? spec.photos[view.photo].camera
                                                                    : spec.name;
    }
    sum += here, points += seen;
    r2 += step.dot(view.JtJ * step), pixels += view.count;
  }
  if (points > 0.0) out.px = std::sqrt(sum / points);
  if (pixels > 0.0) out.chi = std::sqrt(std::max(r2, 0.0) / pixels);
  return out;
}

}  // namespace hookeye
