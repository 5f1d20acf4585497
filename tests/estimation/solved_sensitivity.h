// S = dq/dp as a workspace has it, and by differences of equilibria that are solved again; all of
// the block's scene.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "estimation/effects_scene.h"
#include "estimation/evaluation/evaluation.h"

namespace hookeye::test {

using States = std::vector<VectorXd>;  ///< q of every example

States solve(const ModelForm& form, const VectorXd& p, const States& start);
/// S by differences of solved equilibria, one-sided where the bound leaves no room.
States solved_sensitivity(const ModelForm& form, const VectorXd& p, int k, double h, bool one_sided,
                          const States& start);
Workspace& workspace();
/// S of `form` at p, and of candidates at their nulls beyond it.
Evaluation evaluated(const ModelForm& form, const VectorXd& p,
                     const std::vector<std::shared_ptr<const Ingredient>>& candidates);
/// Largest over the examples of |S - S_solved| against the largest |S_solved|. False where the
/// parameter moves nothing (a plane out of reach): S is zero and the differences of positions are
/// rounding.
bool expect_same(const Evaluation& evaluation, int column, const States& solved, double h,
                 double relative, const std::string& label);

}  // namespace hookeye::test
