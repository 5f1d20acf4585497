// What the catalogue offers a fitted model: the candidates that a diagnosis scores.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "estimation/diagnosis/diagnosis.h"
#include "estimation/diagnosis/diagnosis_sums.h"
#include "estimation/fit/evidence.h"

namespace hookeye {

/// One form of an effect (a direction, a place) with its columns of the normal equations.
struct Candidate {
  const Effect* effect;
  std::shared_ptr<const Ingredient> ingredient;
  Hypothesis hypothesis;
};

/// All candidates with their columns; effects that do not apply go straight to `idle`.
std::vector<Candidate> collect_candidates(const Fitted& fitted, const DiagnosisOptions& options,
                                          std::vector<EffectScore>& idle);

/// Evidence of every effect from its candidates' evidence: the mean over them.
std::map<std::string, double> by_effect(const std::vector<Candidate>& candidates,
                                        const VectorXd& evidence);

/// Largest evidence over the catalogue when nothing is missing, sorted: scores drawn as the floor's
/// errors (their variance and their correlation from cell to cell, rest photos) would give them.
/// The same draws in any frame, unit and order (gram.h, square_root).
std::vector<double> simulate_null(const ModelForm& base, const std::vector<Candidate>& candidates,
                                  const std::vector<ProjectedHypothesis>& projected,
                                  const DiagnosisSums& sums, const DiagnosisOptions& options);

/// Share of each effect's signature that the others can imitate beside the base columns, where its
/// cosine is above `least`.
/// `projected` from H, `best`: each effect's candidate.
void find_confusions(const Eigen::MatrixXd& H, const std::vector<ProjectedHypothesis>& projected,
                     const std::map<std::string, size_t>& best, double least,
                     std::vector<EffectScore>& scores);

}  // namespace hookeye
