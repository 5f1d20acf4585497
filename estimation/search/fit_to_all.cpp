#include "estimation/search/fit_to_all.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/distributions.h"
#include "estimation/effects/catalogue.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/fit/at_floor.h"
#include "estimation/search/contest.h"
#include "estimation/search/measured_explained.h"
#include "estimation/search/swaps.h"

namespace hookeye {

namespace {

/// V of what the fitted photos say, in units of what matters (Scaling's x); those directions that
/// they say nothing of are known to a factor e^30.
Eigen::MatrixXd covariance_of(const Fitted& fitted) {
  const auto parameters = fitted.form.parameters();
  const VectorXd dx_dp = Scaling{parameters}.dp_dx(fitted.p).cwiseInverse();
  return dx_dp.asDiagonal() * parameter_covariance(fitted.evaluation, parameters, fitted.p).all() *
         dx_dp.asDiagonal();
}

/// J^T J/N of the held-out photos (or fields), or of the fitted ones, by all values that are fitted
/// to the latter, in the same units. Those of held-out examples alone follow: H_ss - H_so H_oo^+
/// H_os.
Eigen::MatrixXd shown_by_photos(const Fitted& fitted, bool held_out) {
  const auto parameters = fitted.form.parameters();
  const Eigen::Index n = fitted.p.size();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  double count = 0.0;
  const bool fields = fitted.evaluation.seen() == Evaluation::Seen::fields;
  for (const auto& example : fitted.evaluation.examples) {
    if (example.held_out != held_out) continue;
    for (const auto& photo : example.photos) {
      H += photo.sums.JtJ.topLeftCorner(n, n);
      count += photo.count;
    }
    for (const auto& measured : example.measured) {
      if (!fields || !measured.is_field()) continue;
      H += measured.J.leftCols(n).transpose() * measured.J.leftCols(n);
      count += measured.size();
    }
  }
  if (n == 0 || count == 0.0) return H;
  const VectorXd dp_dx = Scaling{parameters}.dp_dx(fitted.p);
  H = dp_dx.asDiagonal() * H * dp_dx.asDiagonal() / count;
  const auto own = of_held_out(fitted.form.scene->capture, parameters);
  auto shared = own;
  shared.flip();
  const Eigen::MatrixXd of_own = part_of(H, own).completeOrthogonalDecomposition().pseudoInverse();
  return part_of(H - H * of_own * H, shared);
}

/// The model in a scene that holds nothing out; empty where an ingredient is not among those of
/// that scene.
std::optional<std::pair<ModelForm, VectorXd>> holding_nothing_out(const Fitted& fitted) {
  auto scene = std::make_shared<Scene>(*fitted.form.scene);
  for (auto& example : scene->capture.examples) example.validate = false;
  try {
    auto [form, p] = transfer(fitted.form.realise(fitted.p), scene, catalogue());
    const auto parameters = form.parameters();  // bounds may scale with the model
    for (Eigen::Index i = 0; i < p.size(); ++i)
      p[i] = std::clamp(p[i], parameters[i].low, parameters[i].high);
    return std::pair(std::move(form), std::move(p));
  } catch (const std::runtime_error&) {
    return {};
  }
}

void use_as(const Capture& capture, Evaluation& evaluation) {
  for (auto& example : evaluation.examples)
    example.held_out = capture.examples[example.example].validate;
}

/// The effect that stands where the winner of a contest stood.
std::string stands_for_winner(const std::vector<Contested>& past, size_t contest) {
  std::string effect = past[contest].added;
  for (size_t k = contest + 1; k < past.size(); ++k)
    if (std::find(past[k].dropped.begin(), past[k].dropped.end(), effect) != past[k].dropped.end())
      effect = past[k].added;
  return effect;
}

}  // namespace

double spread_of_photos(const Fitted& fitted, bool held_out) {
  const Eigen::MatrixXd VH = covariance_of(fitted) * shown_by_photos(fitted, held_out);
  const double mean = VH.trace(), half_variance = (VH * VH).trace();
  if (mean <= 0.0 || half_variance <= 0.0) return 0.0;
  const double chance = fitted.form.scene->limits->floor.chance;
  return half_variance / mean * chi2_quantile(1.0 - chance, mean * mean / half_variance);
}

std::vector<std::string> values_hardly_known(const Fitted& fitted, const Fitted& all) {
  // V = L L^T: of the moves L u of one standard deviation, that with the largest (L u)^T H L u.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> V(covariance_of(fitted));
  const Eigen::MatrixXd L =
      V.eigenvectors() * V.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> shown(
      Eigen::MatrixXd(L.transpose() * shown_by_photos(fitted, true) * L));
  const VectorXd moves = (L * shown.eigenvectors().rightCols(1)).cwiseAbs();
  const auto parameters = fitted.form.parameters(), there = all.form.parameters();
  std::vector<std::string> out;
  for (Eigen::Index i = 0; i < moves.size(); ++i)
    for (size_t k = 0; k < there.size(); ++k)
      if (moves[i] > fitted.form.scene->limits->search.value_moves * moves.maxCoeff() &&
          there[k].name == parameters[i].name)
        out.push_back(fmt::format("{} {:.4g} (here {:.4g}, {:.4g} .. {:.4g})", parameters[i].name,
                                  all.p[k], fitted.p[i], fitted.low[i], fitted.high[i]));
  return out;
}

Result<std::optional<FitToAll>> fit_to_all(Workspace& workspace, const Fitted& fitted,
                                           const Diagnosis& diagnosis, const FitOptions& options) {
  const std::optional<FitToAll> none;
  const Floor& floor = diagnosis.floor;
  if (!spoils_held_out(fitted, floor) ||
      over_floor(fitted, floor, true) > spread_of_photos(fitted, true))
    return none;
  const auto moved = holding_nothing_out(fitted);
  if (!moved) return none;
  FitOptions warm = options;
  warm.coarse_to_fine = false;
  auto result = fit(workspace, moved->first, moved->second, warm);
  if (!result) {
    if (cancelled(result.error())) return failure_of(result);
    return none;
  }
  FitToAll out;
  out.fitted = *std::move(result);
  Evaluation& all = out.fitted.evaluation;
  use_as(fitted.form.scene->capture, all);
  out.chi_fit = all.chi(false);
  out.chi_validate = all.chi(true);
  const bool explained =
      explains_photos(out.fitted, floor) && measured_explained(out.fitted, diagnosis);
  use_as(out.fitted.form.scene->capture, all);
  const double err = least_fall(diagnosis, fitted.form.ingredients.back()->name());
  const double given_up = std::pow(out.chi_fit, 2) - std::pow(fitted.evaluation.chi(false), 2);
  const double most = spread_of_photos(fitted, false) + err;
  if (!tell(options.decided, {Asked::ended,
                              "values of all load cases",
                              explained && given_up <= most,
                              {given_up, most, "floor.chance"},
                              "what the fitted ones give up where held-out ones are fitted too"}))
    return none;
  out.hardly_known = values_hardly_known(fitted, out.fitted);
  return std::optional(std::move(out));
}

std::vector<std::string> tie_of_all(Workspace& workspace, const FitToAll& all,
                                    const std::vector<Contested>& past,
                                    const std::vector<std::string>& tie, const Floor& floor,
                                    size_t first_effect, const DiscoverOptions& options,
                                    const DiscoverEvents& events) {
  const auto standing = effects_in(all.fitted.form);
  const auto has = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (auto effect = standing.rbegin(); effect != standing.rend(); ++effect) {
    if (numerical(*effect)) continue;
    std::vector<std::string> contest = {*effect};
    if (!tie.empty() && tie.front() == *effect) contest = tie;
    for (size_t k = 0; k < past.size(); ++k)
      for (const Rival& rival : past[k].rivals)
        if (stands_for_winner(past, k) == *effect &&
            rival.chi_fit <= floor.limits->floor.at * floor.chi && !numerical(rival.effect) &&
            !has(standing, rival.effect) && !has(contest, rival.effect))
          contest.push_back(rival.effect);
    if (contest.size() < 2) continue;
    auto asked =
        ask_tie_again(workspace, all.fitted, contest, floor, first_effect, {}, options, events);
    if (!asked) continue;
    if (asked->better) return {*effect, asked->better->in.effect};
    if (!asked->tie.empty()) return std::move(asked->tie);
  }
  return {};
}

}  // namespace hookeye
