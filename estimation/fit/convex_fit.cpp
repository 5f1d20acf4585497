#include "estimation/fit/convex_fit.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "estimation/evaluation/normal_equations.h"
#include "estimation/fit/floor.h"
#include "estimation/model/additive_material.h"

namespace hookeye {

using Eigen::MatrixXd;
namespace {

VectorXd lower_bounds(const Scaling& scaling) {
  VectorXd x(scaling.parameters.size());
  for (int i = 0; i < x.size(); ++i) {
    const Parameter& one = scaling.parameters[i];
    x[i] = one.positive && one.low <= 0.0 ? -std::numeric_limits<double>::infinity()
                                          : scaling.to_x(i, one.low);
  }
  return x;
}

/// Whether control values come from this parameter.
bool is_control_value(const std::vector<ConvexPart>& parts, Eigen::Index parameter) {
  return std::any_of(parts.begin(), parts.end(),
                     [&](const ConvexPart& part) { return !part.by_x.col(parameter).isZero(0.0); });
}

/// The parts by x. Parameters that control values come from share one scale, so that H(x) is a
/// multiple of H(p) and keeps its sign; walls are divided by it like the values.
std::vector<ConvexPart> in_x(std::vector<ConvexPart> by_p, Scaling& scaled) {
  double scale = 0.0;
  std::vector<Parameter*> values;
  for (size_t i = 0; i < scaled.parameters.size(); ++i)
    if (is_control_value(by_p, static_cast<Eigen::Index>(i)))
      values.push_back(&scaled.parameters[i]);
  for (const Parameter* one : values) scale = std::max(scale, one->typical);
  for (Parameter* one : values) one->typical = scale;
  for (ConvexPart& part : by_p)
    for (Addend& a : part.model.addends) a.stiffness /= scale;
  return by_p;
}

double smallest_eigenvalue_of(const ModelForm& form, const VectorXd& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const ConvexPart& part : convex_parts(form, p))
    least = std::min(least, smallest_eigenvalue(part.model).smallest);
  return least;
}

/// How the pictures are compared from here on: as in fit(), far ones by their motion.
Result<EvaluationOptions> comparison(Workspace& workspace, const ModelForm& form, const VectorXd& p,
                                     const FitOptions& options) {
  EvaluationOptions look;
  look.derivatives = false;
  look.pictures = true;
  look.registered = true;
  look.cancel = options.cancel;
  auto first = workspace.evaluate(form, p, look);
  if (!first) return failure_of(first);
  const Evaluation& seen = *first;
  EvaluationOptions out;
  out.cancel = options.cancel;
  out.registered = seen.motion_px() > kLinearPx;
  out.huber = options.huber_times(*form.scene) * misfit_scale(seen);
  out.measured_weight = measured_weight(workspace.scene(), seen);
  return out;
}

double residual_count(const Evaluation& evaluation) {
  double count = 0.0;
  for (const auto& example : evaluation.examples) {
    for (const auto& photo : example.photos) count += photo.count;
    for (const auto& measured : example.measured) count += measured.size();
  }
  return std::max(count, 1.0);
}

/// Normal equations at p, and how many residuals are in them.
struct SumsAt {
  Workspace& workspace;
  const ModelForm& form;
  EvaluationOptions evaluation;
  double residuals = 1.0;
  Result<NormalEquations> operator()(const VectorXd& p) {
    auto result = workspace.evaluate(form, p, evaluation);
    if (!result) return failure_of(result);
    residuals = residual_count(*result);
    return normal_equations(*result);
  }
};

/// Values that the data leave open stay near the start: a Cauchy prior about it, as wide as the
/// material is stiff at rest. It costs what one residual costs on average, and a value that the
/// data want elsewhere little more the farther it goes. Without it noise and the mesh's error move
/// such values by many times the stiffness, which other motions then feel.
struct Draw {
  VectorXd centre, width;  ///< in x; width 0: not drawn
  Draw(const std::vector<ConvexPart>& parts, VectorXd x) : centre(std::move(x)) {
    width.setZero(centre.size());
    for (const ConvexPart& part : parts) {
      double rest = 0.0;
      for (size_t a = 0; a < part.model.addends.size(); ++a)
        if (part.model.addends[a].second < 0)
          rest = std::max(rest, addend_curve(part.model, static_cast<int>(a), 0.0)[2]);
      for (Eigen::Index i = 0; i < width.size(); ++i)
        if (!part.by_x.col(i).isZero(0.0)) width[i] = std::max(width[i], rest);
    }
  }
  double cost(const VectorXd& x) const {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < x.size(); ++i)
      if (width[i] > 0) sum += std::log1p(std::pow((x[i] - centre[i]) / width[i], 2));
    return sum;
  }
  void add_to(MatrixXd& H, VectorXd& g, const VectorXd& x, double weight) const {
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (!(width[i] > 0)) continue;
      const double d = x[i] - centre[i], share = weight / (width[i] * width[i] + d * d);
      H(i, i) += share;
      g[i] += share * d;
    }
  }
};

/// The damped quadratic model of one step, in x.
struct ConvexStep {
  MatrixXd H;
  VectorXd g;
  /// Minimum of the model over convex control values.
  ConvexProjection solve(const std::vector<ConvexPart>& parts, const VectorXd& x,
                         const VectorXd& low, double damping) const {
    const double floor = 1e-10 * std::max(H.diagonal().maxCoeff(), 1e-300);
    MatrixXd metric = H;
    metric.diagonal() += damping * H.diagonal() + VectorXd::Constant(x.size(), floor);
    const VectorXd target = x - metric.llt().solve(g);
    return project_convex(parts, target, metric, low);
  }
};

}  // namespace

Result<ConvexFit> fit_convex(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                             const FitOptions& options) {
  if (!has_additive(form)) throw std::logic_error("fit_convex: no additive material");
  Scaling scaled{form.parameters()};
  const std::vector<ConvexPart> parts = in_x(convex_parts(form, start), scaled);
  int values = 0;
  for (const ConvexPart& part : parts) values += part.model.size();
  const VectorXd low = lower_bounds(scaled);
  auto chosen = comparison(workspace, form, start, options);
  if (!chosen) return failure_of(chosen);
  const EvaluationOptions evaluation = *chosen;
  SumsAt sums_at{workspace, form, evaluation};
  ConvexFit out;
  out.registered = evaluation.registered;
  out.p = start;
  out.eigenvalues = {smallest_eigenvalue_of(form, start)};
  auto first = sums_at(start);
  if (!first) return failure_of(first);
  NormalEquations sums = *std::move(first);
  const Draw draw(parts, scaled.to_x(start));
  double damping = 1e-3;
  for (; out.iterations < options.iterations(*form.scene); ++out.iterations) {
    if (options.cancel && options.cancel->load()) return stopped();
    const VectorXd x = scaled.to_x(out.p), d = scaled.dp_dx(out.p);
    ConvexStep step{d.asDiagonal() * sums.JtJ * d.asDiagonal(), d.cwiseProduct(sums.Jtr)};
    const double noise = sums.r2 / sums_at.residuals;  // variance over what was told
    draw.add_to(step.H, step.g, x, noise);
    bool accepted = false;
    double fall = 0.0;
    // A damping of 1e6 moves nothing: then there is no lower place to go.
    for (; !accepted && damping < 1e6; damping = accepted ? damping : 8.0 * damping) {
      const ConvexProjection next = step.solve(parts, x, low, damping);
      if (!next.converged) continue;
      const VectorXd p = scaled.to_p(next.x);  // the upper bounds are kept here
      const VectorXd move = next.x - x;
      // Below a promise of 0.01 the parameters move by a tenth of their standard deviation.
      if (-2.0 * step.g.dot(move) - move.dot(step.H * move) < 0.01) break;
      if (not_convex(form.realise(p)))
        continue;  // an upper bound took from an addend that others need
      auto trial = sums_at(p);
      if (!trial) {
        if (cancelled(trial.error())) return failure_of(trial);
        continue;  // no equilibrium there: a shorter step
      }
      NormalEquations& there = *trial;
      fall = sums.r2 - there.r2 + noise * (draw.cost(x) - draw.cost(next.x));
      if (!(fall > 0)) continue;
      sums = std::move(there);
      out.p = p;
      out.eigenvalues.push_back(smallest_eigenvalue_of(form, p));
      accepted = true;
    }
    if (options.progress)
      options.progress({fmt::format("additive, {} values", values), out.iterations + 1,
                        options.iterations(*form.scene), std::sqrt(sums.r2 / sums_at.residuals)});
    if (!accepted || fall < 1e-5 * sums.r2) {
      out.converged = true;
      break;
    }
    damping = std::max(0.2 * damping, 1e-9);
  }
  return out;
}

Result<Fitted> fit_convex_to_end(Workspace& workspace, const ModelForm& form, const VectorXd& start,
                                 const FitOptions& options) {
  VectorXd p = start;
  ConvexFit last;
  double least = std::numeric_limits<double>::infinity();
  int iterations = 0;
  // By motion first where the pictures are far, then by pixels.
  for (int phase = 0; phase < 2; ++phase) {
    auto moved = fit_convex(workspace, form, p, options);
    if (!moved) return failure_of(moved);
    last = *std::move(moved);
    p = last.p;
    iterations += last.iterations;
    least = std::min(least, *std::min_element(last.eigenvalues.begin(), last.eigenvalues.end()));
    if (!last.registered) break;
  }
  auto settled = settle_held_out(workspace, form, p, options);
  if (!settled) return failure_of(settled);
  auto out = assess(workspace, form, *settled, options);
  if (out) {
    out->iterations = iterations;
    out->converged = last.converged;
    out->smallest_eigenvalue = least;
  }
  return out;
}

}  // namespace hookeye
