#include "app/commands/tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/text.h"
#include "estimation/verdict.h"

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

/// 0: null, or left out.
double number_in(const nlohmann::json& object, const char* key) {
  return object.contains(key) && object[key].is_number() ? object[key].get<double>() : 0.0;
}

}  // namespace

std::string parameter_table(const Fitted& fitted) {
  std::vector<std::vector<std::string>> rows = {
      {"parameter", "value", "95 % interval", "unit", ""}};
  const auto parameters = fitted.form.parameters();
  for (size_t i = 0; i < parameters.size(); ++i)
    rows.push_back({parameters[i].name, fmt::format("{:.5g}", fitted.p[i]),
                    fmt::format("{:.5g} .. {:.5g}", fitted.low[i], fitted.high[i]),
                    parameters[i].unit, parameters[i].long_name});
  std::string text = table(rows);
  for (const auto& sentence : effects_in_words(fitted)) text += wrapped(sentence, 2);
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

namespace {

/// "creep", "creep anew" where it took its own place, "creep, without softening".
std::string with_dropped(std::string name, std::vector<std::string> dropped) {
  if (std::erase(dropped, name)) name += " anew";
  return dropped.empty() ? name : fmt::format("{}, without {}", name, fmt::join(dropped, ", "));
}

}  // namespace

std::string name_of(const Step& step) { return with_dropped(step.name, step.dropped); }

std::string steps_table(const nlohmann::json& timeline) {
  std::vector<std::vector<std::string>> rows = {
      {"step", "chi fitted", "chi held out", "rms px", "over the floor"}};
  const auto& steps = timeline.at("steps");
  const double floor = timeline.at("floor").at("chi");
  const double top = steps.front().at("chi_fit").get<double>() / floor;
  for (const auto& step : steps) {
    const double chi = step.at("chi_fit"), over = chi / floor;
    rows.push_back(
        {with_dropped(step.at("name"), step.value("dropped", std::vector<std::string>())),
         chi_text(chi), chi_text(number_in(step, "chi_validate")),
         fmt::format("{:.3f}", number_in(step, "rms_px_fit")),
         fmt::format("{:.2f} {}", over, bar(over / top, 20).substr(7))});
  }
  return table(rows);
}

std::string choice_table(const nlohmann::json& before, const nlohmann::json& step) {
  constexpr size_t kMost = 6;
  const nlohmann::json none = nlohmann::json::array();
  const auto raced = step.value("raced", none), rivals = step.value("rivals", none);
  if (raced.size() < 2) return "";
  const std::string added = step.at("added");
  std::vector<std::vector<std::string>> rows = {{"effect", "evidence", "tried: chi fitted",
                                                 "held out", "refitted: chi fitted", "held out",
                                                 "behind"}};
  const auto chi = [](const nlohmann::json& one, const char* key) {
    const double value = number_in(one, key);
    return value > 0.0 ? fmt::format("{:.2f}", value) : "-";
  };
  const auto of = [](const nlohmann::json& list, const std::string& effect) {
    for (const auto& one : list)
      if (one.at("effect") == effect) return one;
    return nlohmann::json();
  };
  const auto scores = before.value("diagnosis", none);
  for (const auto& one : raced) {
    const std::string effect = one.at("effect");
    const nlohmann::json score = of(scores, effect);
    const nlohmann::json refit = effect == added ? step : of(rivals, effect);
    if (rows.size() > kMost && refit.is_null()) continue;
    rows.push_back({effect,
                    score.is_null() ? "-" : fmt::format("{:.1f}", number_in(score, "evidence")),
                    chi(one, "chi_fit"), chi(one, "chi_validate"),
                    refit.is_null() ? "" : chi(refit, "chi_fit"),
                    refit.is_null() ? "" : chi(refit, "chi_validate"),
                    refit.is_null()   ? ""
                    : effect == added ? "-"
                                      : fmt::format("{:.1f}", -number_in(refit, "score"))});
  }
  return "\n" +
         wrapped(
             fmt::format("why {}: what each of the {} effects that stood out leaves (tried: after "
                         "two steps of its refit, half-size photos; behind: in the refits' log "
                         "likelihood less the price of their parameters, below {:.0f} is a tie)",
                         added, raced.size(), kTie)) +
         table(rows);
}

}  // namespace hookeye
