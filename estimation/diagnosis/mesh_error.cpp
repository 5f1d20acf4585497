#include "estimation/diagnosis/mesh_error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "estimation/effects/catalogue.h"
#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

/// Those that `mesh_shift` takes beyond their intervals for noise.
std::string moved_by_mesh(const Fitted& fitted, const VectorXd& mesh_shift) {
  const auto parameters = fitted.form.parameters();
  std::vector<std::string> moved;
  for (int i = 0; i < mesh_shift.size(); ++i) {
    const double half = 0.5 * (fitted.high[i] - fitted.low[i]);
    if (std::abs(mesh_shift[i]) > half)
      moved.push_back(fmt::format("{} by {:+.2g}{}{}", parameters[i].name, mesh_shift[i],
                                  parameters[i].unit.empty() ? "" : " ", parameters[i].unit));
  }
  return fmt::format("{}", fmt::join(moved, ", "));
}

/// Mean square of what fitted measured values change by the column `at` times `amount`, the first
/// columns moving by `shift`.
double change_of_measured(const Evaluation& evaluation, Eigen::Index at, double amount,
                          const VectorXd& shift) {
  double sum = 0.0, count = 0.0;
  for (const auto& example : evaluation.examples)
    for (const auto& measured : example.measured) {
      if (example.held_out || measured.is_field()) continue;
      sum +=
          (measured.J.leftCols(shift.size()) * shift + amount * measured.J.col(at)).squaredNorm();
      count += measured.size();
    }
  return count > 0.0 ? sum / count : 0.0;
}

/// The force that stands for a share of the refinement is dead: with twice the modulus it moves the
/// body half as far, while a mesh errs by as much. So the column of a modulus has some of the
/// share's in it, and the two would be traded for each other: by factors, where a prescribed motion
/// leaves the photos nothing else of the modulus. By how much of it, for each parameter.
VectorXd share_in_moduli(const Fitted& fitted, double share) {
  VectorXd out = VectorXd::Zero(fitted.form.size());
  if (share == 0.0) return out;
  const auto log_modulus = [&](const VectorXd& p) {
    return std::log(initial_shear_modulus(fitted.form.realise(p).energy));
  };
  Eigen::Index k = 0;
  for (const auto& ingredient : fitted.form.ingredients)
    for (const Parameter& parameter : ingredient->parameters()) {
      const Eigen::Index own = k++;
      if (!ingredient->touches().energy) continue;
      const double h = 1e-5 * std::max(std::abs(fitted.p[own]), 1e-3 * parameter.typical);
      VectorXd above = fitted.p, below = fitted.p;
      above[own] += h, below[own] -= h;
      out[own] = share * (log_modulus(above) - log_modulus(below)) / (2.0 * h);
    }
  return out;
}

/// The share of a refinement that a model has fitted, and sums in which its column is the last of
/// the base: the others are what it and all candidates are projected against, without what they
/// have of the share.
struct FittedShare {
  Eigen::Index at = 0, last = 0;
  VectorXd in_moduli;  ///< share_in_moduli()
  double next = 0.0;   ///< share that the next refinement would change
  Eigen::MatrixXd H;
  ProjectedHypothesis column;
};

std::optional<FittedShare> fitted_share(const Fitted& fitted, const Eigen::MatrixXd& H) {
  FittedShare out;
  for (const auto& ingredient : fitted.form.ingredients) {
    const auto parameters = ingredient->parameters();
    const Effect* effect = find_effect(ingredient->name());
    if (effect && parameters.size() == 1 && effect->remeshes(ingredient->variant())) {
      out.last = fitted.form.size() - 1;
      out.next = parameters[0].typical;
      out.H = H;
      out.in_moduli = share_in_moduli(fitted, fitted.p[out.at]);
      for (Eigen::Index k = 0; k < out.in_moduli.size(); ++k)
        out.H.col(k) += out.in_moduli[k] * out.H.col(out.at);
      for (Eigen::Index k = 0; k < out.in_moduli.size(); ++k)
        out.H.row(k) += out.in_moduli[k] * out.H.row(out.at);
      out.H.row(out.at).swap(out.H.row(out.last));
      out.H.col(out.at).swap(out.H.col(out.last));
      Hypothesis change;
      change.first = static_cast<int>(out.last), change.count = 1;
      change.typical = VectorXd::Ones(1);
      out.column = project(out.H, static_cast<int>(out.last), change);
      return out;
    }
    out.at += static_cast<Eigen::Index>(parameters.size());
  }
  return std::nullopt;
}

}  // namespace

const Candidate* mesh_candidate(const std::vector<Candidate>& candidates,
                                const VectorXd& evidence) {
  const Candidate* out = nullptr;
  double most = -1.0;
  for (size_t i = 0; i < candidates.size(); ++i)
    if (candidates[i].effect->group() == EffectGroup::numerical && evidence[i] > most)
      out = &candidates[i], most = evidence[i];
  return out;
}

VectorXd tell_of_mesh(const Fitted& fitted, const Evaluation& evaluation, const DiagnosisSums& sums,
                      const Candidate& mesh, Diagnosis& out) {
  const int base = fitted.form.size();
  const bool linear = fitted.form.scene->body->mesh.order == 1;
  const double to_the_limit =
      1.0 / (1.0 - (linear ? fitted.form.scene->limits->diagnosis.order_change
                           : kFinerEdge * kFinerEdge));
  VectorXd next = VectorXd::Zero(base);
  if (base > 0) next = -project(sums.fitted.JtJ, base, mesh.hypothesis).to_base.col(0);
  out.mesh_shift = to_the_limit * next;
  out.mesh_in_measured =
      change_of_measured(evaluation, mesh.hypothesis.first, to_the_limit, out.mesh_shift);
  const std::string moved = moved_by_mesh(fitted, next);
  if (!moved.empty())
    out.mesh_note = fmt::format(
        "{} would move {}; the intervals allow for it (add mesh_resolution to fit on it)",
        linear ? std::string("quadratic tetrahedra")
               : fmt::format("a finer mesh, {} times the edge,", kFinerEdge),
        moved);
  VectorXd step = VectorXd::Zero(evaluation.columns);
  step.head(base) = out.mesh_shift;
  step[mesh.hypothesis.first] = to_the_limit;
  return step;
}

VectorXd tell_of_refined_mesh(const Fitted& fitted, const Evaluation& evaluation,
                              const DiagnosisSums& sums, Diagnosis& out) {
  const auto share = fitted_share(fitted, sums.fitted.JtJ);
  if (!share) return {};
  const double next = share->next;
  out.mesh_fall = std::pow(next, 2) * share->column.M(0, 0) / std::max(sums.photo_count, 1.0);
  VectorXd by_share = VectorXd::Zero(share->last + 1);
  by_share.head(share->last) = -share->column.to_base.col(0);
  std::swap(by_share[share->at], by_share[share->last]);
  VectorXd change = next * by_share;
  change[share->at] += next + share->in_moduli.dot(change);
  const Eigen::MatrixXd& held_out = sums.seen_held_out.JtJ;
  if (sums.held_count > 0.0)
    out.mesh_fall_held_out =
        change.dot(held_out.topLeftCorner(change.size(), change.size()) * change) / sums.held_count;
  const double left = next / (1.0 - next) - fitted.p[share->at];
  out.mesh_shift = left * by_share;
  VectorXd others = out.mesh_shift;
  others[share->at] = 0.0;
  out.mesh_in_measured = change_of_measured(evaluation, share->at, left, others);
  const std::string moved = moved_by_mesh(fitted, (1.0 - next) * out.mesh_shift);
  if (!moved.empty())
    out.mesh_note = fmt::format(
        "a still finer mesh would move {}, by what the refinement changed; the intervals allow for "
        "it",
        moved);
  VectorXd step = VectorXd::Zero(std::max<Eigen::Index>(evaluation.columns, change.size()));
  step.head(change.size()) = change;
  return step;
}

double imitated_by_mesh(const Fitted& fitted, const DiagnosisSums& sums,
                        const Hypothesis& hypothesis) {
  const auto share = fitted_share(fitted, sums.fitted.JtJ);
  if (!share) return 0.0;
  const ProjectedHypothesis effect = project(share->H, static_cast<int>(share->last), hypothesis);
  const VectorXd change = share->next * share->H.col(share->last);
  return std::max(effect.fall(change), effect.fall(-change)) / std::max(sums.photo_count, 1.0);
}

void reach_for_mesh(Fitted& fitted, const Diagnosis& diagnosis) {
  fitted.mesh_reach = diagnosis.mesh_shift;
  widen_by_mesh(fitted);
}

}  // namespace hookeye
