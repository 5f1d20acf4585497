#include "tests/estimation/repeats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/distributions.h"
#include "estimation/effects/toolbox.h"

namespace hookeye::test {

namespace {

constexpr double kTrueMu = 0.02;  ///< SmallCapture's

Repeat of_interval(const Fitted& fitted) {
  Repeat out;
  out.covered = fitted.low[0] <= kTrueMu && kTrueMu <= fitted.high[0];
  out.over_deviation = std::log(fitted.p[0] / kTrueMu) /
                       (std::log(fitted.high[0] / fitted.low[0]) / (2.0 * kNormal95));
  return out;
}

}  // namespace

Repeat repeat_fit(const SmallCapture& capture) {
  const SmallScene small(capture);
  Workspace workspace(small.scene);
  return of_interval(base_fit(workspace));
}

Repeat repeat(const SmallCapture& capture, const DiagnosisOptions& options) {
  const SmallScene small(capture);
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  auto fitted = fit(workspace, form, form.initial()).value();
  const auto diagnosis = diagnose(workspace, fitted, options).value();
  const bool other_mesh = capture.truth_mesh != "1";
  if (other_mesh) reach_for_mesh(fitted, diagnosis);
  Repeat out = of_interval(fitted);
  out.first = diagnosis.effects.front().effect;
  for (const auto& effect : diagnosis.effects) {
    out.p_value = std::min(out.p_value, effect.p_value);
    out.fall[effect.effect] = effect.fall;
    const bool is_there = other_mesh && effect.effect == "mesh_resolution";
    if (out.named.empty() && !is_there && nameable(effect, diagnosis))
      out.named = fmt::format("{} (as {:.4f} px would)", effect.effect,
                              std::sqrt(effect.fall / diagnosis.floor.per_px2));
  }
  return out;
}

Searched search(const SmallCapture& capture) {
  const Discovery found = discover(SmallScene(capture));
  const Fitted& last = found.steps.back().fitted;
  Searched out;
  for (const std::string& name : found.missing)
    if (name != "mesh_resolution") out.wrong += (out.wrong.empty() ? "" : "+") + name;
  out.verdict = to_string(found.verdict);
  out.mu = last.p[0];
  out.low = last.low[0];
  out.high = last.high[0];
  out.covered = out.low <= kTrueMu && kTrueMu <= out.high;
  return out;
}

std::vector<std::shared_ptr<const Ingredient>> Placebo::candidates(const Model&,
                                                                   std::string*) const {
  IngredientSpec spec;
  spec.name = name();
  // 0.02 N in all moves these bodies by about as much as a moderate effect
  spec.parameters = {{"placebo.f", "N", "forces at random", 0.0, -1.0, 1.0, 0.02, false}};
  spec.touches = {.loading = true};
  spec.apply = [seed = seed_](const VectorXd& f, Model& m) {
    const TetMesh& mesh = m.scene->body->mesh;
    const BodySize size = body_size(*m.scene);
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal;
    for (ExampleModel& example : m.examples) {
      // A direction that turns and grows over the body, as one element of a load would.
      Eigen::Matrix<double, 3, 4> field;
      for (double& c : field.reshaped()) c = normal(engine);
      VectorXd force(3 * mesh.nodes());
      for (int a = 0; a < mesh.nodes(); ++a) {
        const Vector3d X = 2.0 * (mesh.X.col(a) - size.centre) / size.size;
        force.segment<3>(3 * a) = f[0] / mesh.nodes() * (field * X.homogeneous());
      }
      example.loading.forces.push_back(nodal_force(std::move(force)));
    }
  };
  return {make_ingredient(std::move(spec))};
}

double excess_over_uniform(std::vector<double> p) {
  std::sort(p.begin(), p.end());
  double most = 0.0;
  for (size_t i = 0; i < p.size(); ++i)
    if (p[i] < 1.0) most = std::max(most, (i + 1.0) / static_cast<double>(p.size()) - p[i]);
  return most;
}

double distance_from_uniform(std::vector<double> p) {
  std::sort(p.begin(), p.end());
  double most = excess_over_uniform(p);
  for (size_t i = 0; i < p.size(); ++i)
    if (p[i] < 1.0) most = std::max(most, p[i] - static_cast<double>(i) / p.size());
  return most;
}

namespace {

/// An asymptotic point over sqrt(n) with Stephens' correction (1970), good from n = 5 on.
double corrected(double point, int n) {
  const double root = std::sqrt(static_cast<double>(n));
  return point / (root + 0.12 + 0.11 / root);
}

}  // namespace

double excess_95(int n) { return corrected(1.2239, n); }
double distance_95(int n) { return corrected(1.3581, n); }

int count_95(int n) {
  double sum = 0.0, term = std::pow(0.95, n);
  for (int k = 0; k <= n; ++k) {
    sum += term;
    if (sum >= 0.95) return k;
    term *= (n - k) / (k + 1.0) * 0.05 / 0.95;
  }
  return n;
}

}  // namespace hookeye::test
