// What stands after the steps of a search, and what names took.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "estimation/diagnosis/diagnosis_sums.h"
#include "estimation/search/discover.h"

namespace hookeye {

std::vector<std::string> effects_in(const ModelForm& form) {
  std::vector<std::string> names;
  for (size_t i = base_form(form.scene).ingredients.size(); i < form.ingredients.size(); ++i)
    if (const std::string name = form.ingredients[i]->name();
        std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  return names;
}

Contested contested(const Step& step) {
  const Evaluation& left = step.fitted.evaluation;
  return {step.added,     step.dropped,      step.rivals,      left.chi(false),
          left.chi(true), measured_r2(left), step.not_compared};
}

TakenByNames taken_by_names(const std::vector<Contested>& steps, const Floor& floor) {
  TakenByNames out;
  const auto over = [&](double chi) { return std::max(0.0, chi * chi - floor.chi * floor.chi); };
  for (size_t k = 1; k < steps.size(); ++k) {
    const Contested &before = steps[k - 1], &after = steps[k];
    if (numerical(after.added) ||
        std::any_of(after.dropped.begin(), after.dropped.end(), numerical))
      continue;
    out.fit += over(before.chi_fit) - over(after.chi_fit);
    out.held_out += over(before.chi_validate) - over(after.chi_validate);
    out.measured += before.measured_r2 - after.measured_r2;
  }
  return out;
}

std::string not_compared(const std::vector<Contested>& steps,
                         const std::vector<std::string>& missing) {
  std::vector<std::string> names;
  const auto has = [](const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  for (const Contested& one : steps)
    for (const std::string& name : one.not_compared)
      if (!has(missing, name) && !has(names, name)) names.push_back(name);
  if (names.empty()) return "";
  return fmt::format("; not compared: {}, which stood out as much and could not be fitted",
                     fmt::join(names, ", "));
}

}  // namespace hookeye
