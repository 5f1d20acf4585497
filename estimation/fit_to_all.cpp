#include "estimation/fit_to_all.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "estimation/contest.h"
#include "estimation/evidence.h"
#include "estimation/normal_equations.h"
#include "estimation/swaps.h"

namespace hookeye {

namespace {

/// Standard deviations in units of what matters (Scaling's x).
VectorXd spread_of(const Fitted& fitted, const ParameterCovariance& covariance) {
  const VectorXd dp_dx = Scaling{fitted.form.parameters()}.dp_dx(fitted.p);
  return covariance.all().diagonal().cwiseMax(0.0).cwiseSqrt().cwiseQuotient(dp_dx);
}

/// J^T J of the held-out photos by what the fitted ones determine, and how many pixels they have.
std::pair<Eigen::MatrixXd, double> held_out_photos(const Fitted& fitted) {
  const Eigen::Index n = fitted.p.size();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  double count = 0.0;
  for (const auto& example : fitted.evaluation.examples)
    for (const auto& photo : example.photos) {
      if (!example.held_out) continue;
      H += photo.sums.JtJ.topLeftCorner(n, n);
      count += photo.count;
    }
  auto keep = of_held_out(fitted.form.scene->capture, fitted.form.parameters());
  keep.flip();
  return {part_of(H, keep), count};
}

ParameterCovariance covariance_of(const Fitted& fitted) {
  return parameter_covariance(fitted.evaluation, fitted.form.parameters(), fitted.p);
}

/// chi of those examples of `all`, where every one is fitted, that `uses` holds out or fits.
double chi_by_use(const Evaluation& all, const Capture& uses, bool held_out) {
  double r2 = 0.0, count = 0.0;
  for (const auto& example : all.examples)
    for (const auto& photo : example.photos) {
      if (uses.examples[example.example].validate != held_out) continue;
      r2 += photo.r2, count += photo.count;
    }
  return count > 0.0 ? std::sqrt(r2 / count) : 0.0;
}

/// The model in a scene that holds nothing out; empty where an ingredient is not among those of
/// that scene (its variants come from the fitted examples).
std::optional<std::pair<ModelForm, VectorXd>> holding_nothing_out(const Fitted& fitted) {
  auto scene = std::make_shared<Scene>(*fitted.form.scene);
  for (auto& example : scene->capture.examples) example.validate = false;
  try {
    return transfer(fitted.form.realise(fitted.p), scene);
  } catch (const std::runtime_error&) {
    return {};
  }
}

}  // namespace

double spread_of_held_out(const Fitted& fitted) {
  const auto [H, count] = held_out_photos(fitted);
  if (count == 0.0) return 0.0;
  const Eigen::MatrixXd VH = covariance_of(fitted).determined * H / count;
  const double mean = VH.trace(), half_variance = (VH * VH).trace();
  if (mean <= 0.0 || half_variance <= 0.0) return 0.0;
  return half_variance / mean * chi2_point(mean * mean / half_variance);
}

std::vector<std::string> values_hardly_known(const Fitted& fitted, const Fitted& all) {
  const auto parameters = fitted.form.parameters(), there = all.form.parameters();
  const auto own = of_held_out(fitted.form.scene->capture, parameters);
  VectorXd spread = spread_of(fitted, covariance_of(fitted));
  for (Eigen::Index i = 0; i < spread.size(); ++i)
    if (own[i]) spread[i] = 0.0;
  std::vector<std::string> out;
  for (Eigen::Index i = 0; i < spread.size(); ++i)
    for (size_t k = 0; k < there.size(); ++k)
      if (spread[i] > 0.5 * spread.maxCoeff() && there[k].name == parameters[i].name)
        out.push_back(fmt::format("{} {:.4g} (here {:.4g}, {:.4g} .. {:.4g})", parameters[i].name,
                                  all.p[k], fitted.p[i], fitted.low[i], fitted.high[i]));
  return out;
}

std::variant<std::optional<FitToAll>, NumericalFailure> fit_to_all(Workspace& workspace,
                                                                   const Fitted& fitted,
                                                                   const Diagnosis& diagnosis,
                                                                   const FitOptions& options) {
  using Result = std::variant<std::optional<FitToAll>, NumericalFailure>;
  const std::optional<FitToAll> none;
  const Floor& floor = diagnosis.floor;
  if (!spoils_held_out(fitted, floor) ||
      over_floor(fitted, floor, true) > spread_of_held_out(fitted))
    return none;
  const auto moved = holding_nothing_out(fitted);
  if (!moved) return none;
  FitOptions warm = options;
  warm.coarse_to_fine = false;
  auto result = fit(workspace, moved->first, moved->second, warm);
  if (auto* failure = std::get_if<NumericalFailure>(&result))
    return failure->reason == "cancelled" ? Result(*failure) : none;
  FitToAll out;
  out.fitted = std::get<Fitted>(std::move(result));
  const Capture& uses = fitted.form.scene->capture;
  out.chi_fit = chi_by_use(out.fitted.evaluation, uses, false);
  out.chi_validate = chi_by_use(out.fitted.evaluation, uses, true);
  if (std::max(out.chi_fit, out.chi_validate) > kAtFloor * floor.chi) return none;
  if (!measured_explained(out.fitted, diagnosis)) return none;
  out.hardly_known = values_hardly_known(fitted, out.fitted);
  return std::optional(std::move(out));
}

std::vector<std::string> tie_of_all(Workspace& workspace, const FitToAll& all,
                                    const std::vector<Step>& steps, const Floor& floor,
                                    size_t first_effect, const DiscoverOptions& options,
                                    const DiscoverEvents& events) {
  const auto standing = effects_in(all.fitted.form);
  const auto last = std::find_if(standing.rbegin(), standing.rend(),
                                 [](const std::string& name) { return !numerical(name); });
  if (last == standing.rend()) return {};
  std::vector<std::string> contest = {*last};
  for (const Step& step : steps)
    for (const Rival& rival : step.rivals)
      if (rival.chi_fit <= kAtFloor * floor.chi && !numerical(rival.effect) &&
          std::find(standing.begin(), standing.end(), rival.effect) == standing.end() &&
          std::find(contest.begin(), contest.end(), rival.effect) == contest.end())
        contest.push_back(rival.effect);
  if (contest.size() < 2) return {};
  auto asked =
      ask_tie_again(workspace, all.fitted, contest, floor, first_effect, {}, options, events);
  if (!asked) return {};
  if (asked->better) return {*last, asked->better->in.effect};
  return std::move(asked->tie);
}

}  // namespace hookeye
