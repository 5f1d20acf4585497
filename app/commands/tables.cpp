#include "app/commands/tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/text.h"

namespace hookeye {
namespace {

/// Names that fit on one line of the last column, "+2" for those that do not. The longest effect's
/// name fits in both of its columns.
std::string few(const std::vector<Confusion>& confused) {
  constexpr size_t kRoom = 29;
  std::string text;
  for (size_t i = 0; i < confused.size(); ++i) {
    const size_t more = i + 1 < confused.size() ? 3 : 0;  // " +2"
    const std::string& name = confused[i].effect;
    if (!text.empty() && text.size() + 2 + name.size() + more > kRoom)
      return text + fmt::format(" +{}", confused.size() - i);
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

}  // namespace

std::string parameter_table(const Fitted& fitted) {
  std::vector<std::vector<std::string>> rows = {
      {"parameter", "value", "95 % interval", "unit", ""}};
  const auto parameters = fitted.form.parameters();
  for (size_t i = 0; i < parameters.size(); ++i)
    rows.push_back({parameters[i].name, fmt::format("{:.5g}", fitted.p[i]),
                    fmt::format("{:.5g} .. {:.5g}", fitted.low[i], fitted.high[i]),
                    parameters[i].unit, parameters[i].long_name.substr(0, 40)});
  std::string text = table(rows);
  for (const auto& sentence : fitted.undetermined) text += wrapped(sentence, 2);
  return text;
}

std::string diagnosis_table(const Diagnosis& diagnosis, size_t most) {
  std::vector<std::vector<std::string>> rows = {
      {"effect", "would remove", "evidence", "p", "dof", "easily taken for"}};
  std::string sentences, untestable;
  for (const auto& effect : diagnosis.effects) {
    if (!effect.testable) {
      untestable += wrapped(fmt::format("{}: {}", effect.effect, effect.why_not), 2);
      continue;
    }
    if (rows.size() > most) continue;
    rows.push_back({effect.effect, bar(effect.explains, 7), fmt::format("{:.1f}", effect.evidence),
                    fmt::format("{:.3f}", effect.p_value), fmt::format("{}", effect.dof),
                    few(effect.confused_with)});
    if (rows.size() <= 4 && nameable(effect, diagnosis)) sentences += wrapped(effect.why, 2);
  }
  return table(rows) +
         fmt::format(
             "  named only above evidence {:.1f} (chance alone reaches it in 5 % of runs)\n",
             std::max(diagnosis.gate, kNameable)) +
         sentences + (untestable.empty() ? "" : "not tested\n" + untestable);
}

std::string chi_text(double chi) { return chi > 0.0 ? fmt::format("{:.3f}", chi) : "-"; }

std::string name_of(const Step& step) {
  return step.dropped.empty()
             ? step.name
             : fmt::format("{}, without {}", step.name, fmt::join(step.dropped, ", "));
}

std::string steps_table(const Discovery& discovery) {
  std::vector<std::vector<std::string>> rows = {
      {"step", "chi fitted", "chi held out", "rms px", "over the floor"}};
  const double top = discovery.steps.front().fitted.evaluation.chi(false) / discovery.floor.chi;
  for (const auto& step : discovery.steps) {
    const double over = step.fitted.evaluation.chi(false) / discovery.floor.chi;
    rows.push_back({name_of(step), chi_text(step.fitted.evaluation.chi(false)),
                    chi_text(step.fitted.evaluation.chi(true)),
                    fmt::format("{:.3f}", step.fitted.evaluation.rms_px(false)),
                    fmt::format("{:.2f} {}", over, bar(over / top, 20).substr(7))});
  }
  return table(rows);
}

std::string choice_table(const Step& before, const Step& step) {
  constexpr size_t kMost = 6;
  if (step.raced.size() < 2) return "";
  std::vector<std::vector<std::string>> rows = {
      {"effect", "evidence", "tried: chi fitted", "held out", "refitted: chi fitted", "held out"}};
  const auto chi = [](double value) { return value > 0.0 ? fmt::format("{:.2f}", value) : "-"; };
  for (const Raced& raced : step.raced) {
    const auto same = [&](const auto& one) { return one.effect == raced.effect; };
    const auto& scores = before.diagnosis.effects;
    const auto score = std::find_if(scores.begin(), scores.end(), same);
    const auto refit = std::find_if(step.rivals.begin(), step.rivals.end(), same);
    const bool refitted = refit != step.rivals.end();
    if (rows.size() > kMost && !refitted) continue;
    rows.push_back({raced.effect,
                    score == scores.end() ? "-" : fmt::format("{:.1f}", score->evidence),
                    chi(raced.chi_fit), chi(raced.chi_validate),
                    refitted ? chi(refit->chi_fit) : "", refitted ? chi(refit->chi_validate) : ""});
  }
  return "\n" +
         wrapped(
             fmt::format("why {}: what each of the {} effects that stood out leaves (tried: after "
                         "two steps of its refit, half-size photos)",
                         step.added, step.raced.size())) +
         table(rows);
}

}  // namespace hookeye
