#include "estimation/fit/over_all_pixels.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/work_clock.h"
#include "estimation/fit/floor.h"
#include "estimation/model/additive_material.h"

namespace hookeye {
namespace {

/// H^-1 in units of the fit, without the directions that it says nothing of.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& JtJ, const VectorXd& scale) {
  constexpr double kNothing = 1.0 / 900.0;  // as intervals have it (normal_equations.cpp)
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * JtJ *
                                                             scale.asDiagonal());
  const VectorXd inverse =
      eigen.eigenvalues().unaryExpr([](double l) { return l < kNothing ? 0.0 : 1.0 / l; });
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

/// One Gauss-Newton step from p within the bounds.
VectorXd step_from(const NormalEquations& sums, const Scaling& scaling, const VectorXd& p) {
  const NormalEquations moving = within_bounds(sums, scaling, p);
  const VectorXd scale = scaling.dp_dx(p);
  const VectorXd dx = -inverse_of(moving.JtJ, scale) * scale.cwiseProduct(moving.Jtr);
  VectorXd x = scaling.to_x(p);
  VectorXd out = p;
  const VectorXd to = scaling.to_p(x + dx);
  for (Eigen::Index i = 0; i < p.size(); ++i)
    if (dx[i] != 0.0) out[i] = to[i];
  return out;
}

double root_mean_taken(const Evaluation& evaluation, bool held_out) {
  double r2 = 0.0, count = 0.0;
  for (const auto& example : evaluation.examples)
    if (example.held_out == held_out)
      for (const auto& photo : example.photos) {
        const bool part = photo.taken_count > 0.0;
        r2 += part ? photo.taken_r2 : photo.r2, count += part ? photo.taken_count : photo.count;
      }
  return count > 0.0 ? std::sqrt(r2 / count) : 0.0;
}

double counted(const Evaluation& evaluation, double PhotoEvaluation::*count) {
  double sum = 0.0;
  for (const auto& example : evaluation.examples)
    if (!example.held_out)
      for (const auto& photo : example.photos)
        sum += photo.taken_count > 0.0 ? photo.*count : photo.count;
  return sum;
}

}  // namespace

void take_all_pixels(AllPixels all, Fitted* fitted) {
  tell_intervals(all.error, all.value, fitted);
  widen_by_mesh(*fitted);
  fitted->all_pixels = std::move(all);
}

Result<std::optional<Fitted>> over_all_pixels(Workspace& workspace, const Fitted& fitted,
                                              const FitOptions& options) {
  const Scene& scene = *fitted.form.scene;
  if (!scene.in_part() || fitted.evaluation.seen() != Evaluation::Seen::photos)
    return std::optional<Fitted>();
  const WorkingAt stage(WorkStage::pictures);
  if (options.progress) options.progress({"all pixels", 0, 0, 0.0});
  EvaluationOptions wanted;
  wanted.pictures = wanted.held_out = wanted.all_pixels = true;
  // What the fit has made least, over more pixels.
  wanted.huber = options.huber_times(scene) * misfit_scale(fitted.evaluation);
  wanted.measured_weight = fitted.evaluation.measured_weight;
  wanted.most_iterations = options.most_iterations;
  wanted.cancel = options.cancel;
  auto result = workspace.evaluate(fitted.form, fitted.p, wanted);
  if (!result) return failure_of(result);

  const auto parameters = fitted.form.parameters();
  const Scaling scaling{parameters};
  const VectorXd scale = scaling.dp_dx(fitted.p);
  const Evaluation& read = fitted.evaluation;
  Fitted out = fitted;
  out.evaluation = *std::move(result);
  const NormalEquations sums = normal_equations(out.evaluation);
  AllPixels all;
  // Additive energies stay convex by more than bounds: no step tells where they would go.
  all.value = has_additive(fitted.form) || fitted.p.size() == 0
                  ? fitted.p
                  : step_from(sums, scaling, fitted.p);
  // As they would be there.
  for (auto& example : out.evaluation.examples)
    for (auto& photo : example.photos) photo.sums.Jtr += photo.sums.JtJ * (all.value - fitted.p);
  const ParameterCovariance covariance = parameter_covariance(out.evaluation, parameters, fitted.p);
  all.error = errors_of(covariance);
  all.read_error = errors_of(parameter_covariance(read, parameters, fitted.p));
  const Eigen::MatrixXd more =
      inverse_of(normal_equations(read).JtJ, scale) - inverse_of(sums.JtJ, scale);
  all.added = scale.cwiseProduct(more.diagonal().cwiseMax(0.0).cwiseSqrt());
  all.read_pixels = counted(read, &PhotoEvaluation::count);
  all.share = all.read_pixels / std::max(1.0, counted(out.evaluation, &PhotoEvaluation::count));
  all.pixels = counted(out.evaluation, &PhotoEvaluation::taken_count);
  all.chi_fit = root_mean_taken(out.evaluation, false);
  all.chi_validate = root_mean_taken(out.evaluation, true);
  out.undetermined = covariance.directions;
  take_all_pixels(std::move(all), &out);
  return std::optional<Fitted>(std::move(out));
}

}  // namespace hookeye
