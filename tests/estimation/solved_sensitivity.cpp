#include "estimation/solved_sensitivity.h"

#include <gtest/gtest.h>

namespace hookeye::test {

States solve(const ModelForm& form, const VectorXd& p, const States& start) {
  const Model model = form.realise(p);
  EquilibriumOptions options;
  options.tolerance = 1e-10;
  States q;
  for (size_t e = 0; e < model.examples.size(); ++e) {
    EquilibriumSolver solver(model.scene->mesh());
    auto solved = solver.solve(model.energy_of(static_cast<int>(e)), model.examples[e].loading,
                               options, start.empty() ? nullptr : &start[e]);
    if (!solved) {
      ADD_FAILURE() << model.scene->capture.examples[e].name << ": " << solved.error().reason;
      return {};
    }
    q.push_back(solved->q);
  }
  return q;
}

States solved_sensitivity(const ModelForm& form, const VectorXd& p, int k, double h, bool one_sided,
                          const States& start) {
  auto at = [&](double shift) {
    VectorXd moved = p;
    moved[k] += shift;
    return solve(form, moved, start);
  };
  const States a = at(one_sided ? 2 * h : -h), b = at(h);
  States S;
  for (size_t e = 0; e < a.size() && e < b.size(); ++e)
    S.push_back(one_sided ? VectorXd((-1.5 * start[e] + 2.0 * b[e] - 0.5 * a[e]) / h)
                          : VectorXd((b[e] - a[e]) / (2.0 * h)));
  return S;
}

Workspace& workspace() {
  static Workspace one(block_scene());
  return one;
}

Evaluation evaluated(const ModelForm& form, const VectorXd& p,
                     const std::vector<std::shared_ptr<const Ingredient>>& candidates) {
  EvaluationOptions options;
  options.held_out = true;
  auto result = workspace().evaluate(form, p, options, candidates);
  if (!result) {
    ADD_FAILURE() << result.error().example << ": " << result.error().reason;
    return {};
  }
  return *std::move(result);
}

bool expect_same(const Evaluation& evaluation, int column, const States& solved, double h,
                 double relative, const std::string& label) {
  double predicted = 0.0, scale = 0.0, error = 0.0;
  for (const auto& example : evaluation.examples) {
    predicted = std::max(predicted, example.S.col(column).norm());
    scale = std::max(scale, solved[example.example].norm());
    error = std::max(error, (example.S.col(column) - solved[example.example]).norm());
  }
  if (predicted == 0.0) {
    EXPECT_LT(scale * h, 1e-6) << label << ": S is zero but positions [mm] move";
    return false;
  }
  EXPECT_LT(error, relative * scale) << label;
  return true;
}

}  // namespace hookeye::test
