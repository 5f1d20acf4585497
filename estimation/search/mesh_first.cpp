#include "estimation/search/mesh_first.h"

#include <algorithm>
#include <cmath>

namespace hookeye {

bool may_be_all(const std::string& effect, const Diagnosis& diagnosis) {
  return numerical(effect) &&
         std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(), [&](const auto& score) {
           return score.effect == effect &&
                  score.explains > diagnosis.floor.limits->search.mesh_may_be_all;
         });
}

namespace {

/// The mesh, where it stands out and nobody is `ahead(other, mesh)`; else null.
template <class Ahead>
const EffectScore* mesh_unless(const Diagnosis& diagnosis, const Ahead& ahead) {
  for (const EffectScore& score : diagnosis.effects)
    if (numerical(score.effect) && nameable(score, diagnosis) &&
        std::none_of(diagnosis.effects.begin(), diagnosis.effects.end(), [&](const auto& other) {
          return &other != &score && other.testable && ahead(other, score);
        }))
      return &score;
  return nullptr;
}

/// The mesh, where it leads by more than a tie; else null.
const EffectScore* leading_mesh(const Diagnosis& diagnosis) {
  const double tie = diagnosis.limits().tie;
  return mesh_unless(diagnosis, [&](const EffectScore& other, const EffectScore& mesh) {
    return other.evidence > mesh.evidence - tie;
  });
}

}  // namespace

const EffectScore* mesh_ahead(const Diagnosis& diagnosis) {
  const double tie = diagnosis.limits().tie;
  return mesh_unless(diagnosis, [&](const EffectScore& other, const EffectScore& mesh) {
    return other.evidence > mesh.evidence + tie && other.fall > mesh.fall;
  });
}

bool mesh_settles_it(const Step& step) {
  const EffectScore* mesh = leading_mesh(step.diagnosis);
  const double floor2 = step.diagnosis.floor.chi * step.diagnosis.floor.chi;
  const double at = step.diagnosis.floor.limits->floor.at;
  const auto at_floor_after = [&](bool held_out, double share) {
    const double r2 = std::pow(step.fitted.evaluation.chi(held_out), 2);
    return r2 - share * (r2 - floor2) <= at * at * floor2;
  };
  return mesh && at_floor_after(false, mesh->explains) &&
         at_floor_after(true, mesh->explains_held_out);
}

bool mesh_kept_its_word(const Step& step, const Fitted& refitted) {
  const EffectScore* mesh = mesh_ahead(step.diagnosis);
  const SearchLimits& limits = step.diagnosis.floor.limits->search;
  if (!mesh || mesh->values[0] < limits.mesh_least || mesh->values[0] > limits.mesh_most)
    return false;
  const auto r2 = [](const Fitted& fitted) { return std::pow(fitted.evaluation.chi(false), 2); };
  const double structured = r2(step.fitted) - std::pow(step.diagnosis.floor.chi, 2);
  return r2(step.fitted) - r2(refitted) >= limits.mesh_keeps * mesh->explains * structured;
}

}  // namespace hookeye
