#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "estimation/diagnosis/diagnosis.h"
#include "estimation/diagnosis/diagnosis_json.h"
#include "estimation/effects/catalogue.h"

namespace hookeye {

double least_fall(const Diagnosis& diagnosis, const std::string& effect, bool held_out) {
  const auto score = std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(),
                                  [&](const auto& one) { return one.effect == effect; });
  return std::max(renderers_err_by(diagnosis.floor), held_out ? diagnosis.mesh_fall_held_out
                                                     : score == diagnosis.effects.end()
                                                         ? diagnosis.mesh_fall
                                                         : score->mesh_fall);
}

bool sensors_alone(const Ingredient& ingredient) {
  const Touches touches = ingredient.touches();
  return touches.measured && !touches.energy && !touches.loading && !touches.photos;
}

bool brightness_alone(const Ingredient& ingredient) {
  const Touches touches = ingredient.touches();
  return touches.photos && !touches.energy && !touches.loading && !touches.cameras;
}

std::vector<std::string> leaders(const Diagnosis& diagnosis) {
  std::vector<const EffectScore*> named;
  for (const EffectScore& score : diagnosis.effects)
    if (nameable(score, diagnosis)) named.push_back(&score);
  std::vector<std::string> out;
  for (const EffectScore* score : named) {
    const EffectScore* first = named.front();
    const bool ties =
        score->evidence > first->evidence - diagnosis.limits().tie || score->bic > first->bic;
    if (score == first || (ties && !numerical(score->effect) && !numerical(first->effect)))
      out.push_back(score->effect);
  }
  return out;
}

std::string conclusion(const Diagnosis& diagnosis) {
  const auto all = leaders(diagnosis);
  if (all.empty()) return "nothing of the catalogue stands out";
  if (numerical(all.front()))
    return fmt::format("a finer mesh comes before any other effect ({})", all.front());
  if (all.size() == 1) return all.front() + " stands out as missing";
  // Views are planned by cameras alone.
  const bool photos = diagnosis.floor.source.ends_with("photos");
  return fmt::format(
      "{} stands out as missing, and {} cannot be told from it by these scores: `hookeye discover` "
      "refits all of them{}",
      all.front(), fmt::join(all.begin() + 1, all.end(), ", "),
      photos ? ", `hookeye plan` names loads and views that would separate them" : "");
}

bool numerical(const std::string& effect) {
  const Effect* found = find_effect(effect);  // null: not of the catalogue (DiagnosisOptions::also)
  return found && found->group() == EffectGroup::numerical;
}

bool sensors_speak(double fall, const Diagnosis& diagnosis) {
  return 0.5 * fall / (1.0 + diagnosis.mesh_in_measured) >= diagnosis.limits().nameable;
}

bool held_out_say_so(const EffectScore& score, const Diagnosis& diagnosis) {
  if (numerical(score.effect) || score.explains_held_out <= diagnosis.limits().held_out_share)
    return false;
  return diagnosis.held_out_missed ||
         (diagnosis.held_out_over && score.evidence >= diagnosis.limits().nameable &&
          score.fall_held_out >= least_fall(diagnosis, score.effect, true));
}

std::vector<Decision> naming_decisions(const Diagnosis& diagnosis) {
  std::vector<Decision> out;
  const Decided keep = [&](const Decision& one) { out.push_back(one); };
  const double least = std::max(diagnosis.gate, diagnosis.limits().nameable);
  const char* option =
      diagnosis.gate > diagnosis.limits().nameable ? "diagnosis.gate" : "diagnosis.nameable";
  for (const EffectScore& score : diagnosis.effects) {
    const bool named = nameable(score, diagnosis);
    Decision one{Asked::named, score.effect, named, {}, ""};
    if (!score.testable) {
      one.why = score.why_not;
    } else {
      one.by = {score.evidence, least, option};
      one.why = named ? score.why : not_named_because(score, diagnosis);
    }
    tell(keep, one);
  }
  return out;
}

bool nameable(const EffectScore& score, const Diagnosis& diagnosis) {
  if (!score.testable || score.evidence < diagnosis.gate) return false;
  if (held_out_say_so(score, diagnosis)) return true;
  return score.evidence >= diagnosis.limits().nameable &&
         ((score.best && sensors_alone(*score.best)) ||
          score.fall >= least_fall(diagnosis, score.effect) ||
          (!numerical(score.effect) && sensors_speak(score.measured_fall, diagnosis)));
}

}  // namespace hookeye
