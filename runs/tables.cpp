#include "runs/tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "estimation/diagnosis/diagnosis_json.h"
#include "estimation/fit/at_floor.h"
#include "estimation/model/parameters_json.h"
#include "estimation/output/step_json.h"
#include "estimation/search/contest.h"
#include "estimation/search/verdict.h"
#include "runs/text.h"

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

/// The least that the simulated null can tell is an upper bound.
std::string p_text(double p) {
  const double least = 1.0 / (1.0 + DiagnosisLimits{}.simulations);
  return p < 1.001 * least ? fmt::format("<{:.3f}", p + 0.0005) : fmt::format("{:.3f}", p);
}

}  // namespace

double number_in(const nlohmann::json& object, const char* key) {
  return object.contains(key) && object[key].is_number() ? object[key].get<double>() : 0.0;
}

std::string parameter_table(const Fitted& fitted) {
  std::vector<std::vector<std::string>> rows = {
      {"parameter", "value", "95 % interval", "unit", ""}};
  Eigen::Index i = 0;
  for (const auto& ingredient : fitted.form.ingredients)
    for (const Parameter& parameter : ingredient->parameters()) {
      const Eigen::Index own = i++;
      if (ingredient->name() == "material") continue;
      const auto [low, high] = interval_within(parameter, fitted.low[own], fitted.high[own]);
      const bool unknown = centre_is_unknown(parameter, low, high);
      rows.push_back({parameter.name, unknown ? "somewhere" : fmt::format("{:.5g}", fitted.p[own]),
                      fmt::format("{:.5g} .. {:.5g}", low, high), parameter.unit,
                      parameter.long_name});
    }
  std::string text = rows.size() > 1 ? table(rows) : "";
  for (const auto& sentence : effects_in_words(fitted)) text += wrapped(sentence, 2);
  for (const auto& sentence : fitted.undetermined) text += wrapped(sentence, 2);
  return text;
}

std::string diagnosis_table(const Diagnosis& diagnosis, const std::string& seen, size_t most) {
  std::vector<std::vector<std::string>> rows = {
      {"effect", "would remove", "log BF", "p", "dof", "confused with"}};
  std::string sentences, untestable;
  for (const auto& effect : diagnosis.effects) {
    if (!effect.testable) {
      untestable += wrapped(fmt::format("{}: {}", effect.effect, effect.why_not), 2);
      continue;
    }
    if (rows.size() > most) continue;
    rows.push_back({effect.effect, bar(effect.explains, 7), fmt::format("{:.1f}", effect.evidence),
                    p_text(effect.p_value), fmt::format("{}", effect.dof),
                    few(effect.confused_with)});
    if (rows.size() <= 4 && nameable(effect, diagnosis)) sentences += wrapped(effect.why, 2);
    // Why the leader is not named where its figure alone would do.
    if (rows.size() == 2 &&
        effect.evidence >= std::max(diagnosis.gate, diagnosis.limits().nameable))
      if (const auto why = not_named_because(effect, diagnosis); !why.empty())
        sentences += wrapped(fmt::format("{} is not named: {}", effect.effect, why), 2);
  }
  return table(rows) +
         fmt::format(
             "  would remove: share of the excess misfit; log BF: log Bayes factor against no "
             "effect (5: 150 to 1)\n"
             "  confused with: changes these {} nearly alike, whether it is there or not\n"
             "  named only above {:.1f}, the 95 % critical value over all effects (chance alone)\n",
             seen, std::max(diagnosis.gate, diagnosis.limits().nameable)) +
         (diagnosis.held_out_missed && diagnosis.gate < diagnosis.limits().nameable
              ? wrapped(
                    fmt::format("or above {:.1f} where it would remove most of what the held-out "
                                "{}, which alone show that something is missing, have over "
                                "the floor",
                                diagnosis.gate, seen),
                    2)
              : "") +
         sentences + (untestable.empty() ? "" : "not tested\n" + untestable);
}

std::string chi_text(double chi) { return chi > 0.0 ? fmt::format("{:.3f}", chi) : "-"; }

std::string times_floor(double chi, double floor) {
  return chi > 0.0 ? fmt::format("{:.2f}", floor > 0.0 ? chi / floor : chi) : "-";
}

namespace {

/// "creep", "creep, other parametrisation" where it took its own place, "creep, without softening".
std::string with_dropped(const std::string& name, std::vector<std::string> dropped) {
  const bool itself = std::erase(dropped, name) > 0;
  if (dropped.empty()) return itself ? name + ", other parametrisation" : name;
  return fmt::format("{}, without {}", name, fmt::join(dropped, ", "));
}

}  // namespace

std::string name_of(const Step& step) { return with_dropped(step.name, step.dropped); }

std::string steps_table(const nlohmann::json& timeline) {
  std::vector<std::vector<std::string>> rows = {
      {"step", "residual", "held out", "rms px", "over noise floor"}};
  const auto& steps = timeline.at("steps");
  const double floor = timeline.at("floor").at("chi");
  const double top = steps.front().at("chi_fit").get<double>() / floor;
  for (const auto& step : steps) {
    const double chi = step.at("chi_fit"), over = chi / floor;
    // of what is over the floor at the start
    const double left = top > 1.0 ? std::clamp((over - 1.0) / (top - 1.0), 0.0, 1.0) : 0.0;
    rows.push_back(
        {with_dropped(step.at("name"), step.value("dropped", std::vector<std::string>())),
         chi_text(chi), chi_text(number_in(step, "chi_validate")),
         fmt::format("{:.3f}", number_in(step, "rms_px_fit")),
         fmt::format("{:.2f} {}", over, bar(left, 20).substr(7))});
  }
  return table(rows);
}

namespace {

using nlohmann::json;

/// The entry of an effect in a list of them; null: none.
json entry_of(const json& list, const std::string& effect) {
  for (const auto& one : list)
    if (one.at("effect") == effect) return one;
  return {};
}

/// What was tried and refitted, in multiples of the floor.
std::string choice_rows(const json& before, const json& step, double floor, const Limits& limits) {
  constexpr size_t kMost = 6;
  const json none = json::array();
  const std::string added = step.at("added");
  const auto rivals = step.value("rivals", none), scores = before.value("diagnosis", none);
  std::vector<std::vector<std::string>> rows = {
      {"effect", "log BF", "screening", "held out", "refit", "held out", "behind"}};
  const auto over = [](const json& one, const char* key, double least) {
    return times_floor(number_in(one, key), least);
  };
  // Half-size pictures have their floor from the model before, which may be off at rest, too: who
  // is below it is not better than noise.
  bool unknown = false;
  const auto screened = [&](const json& one, const char* key) {
    constexpr double kRoundsToOne = 0.995;
    const double half = number_in(one, "floor"), chi = number_in(one, key);
    const bool itself = chi > 0.0 && half <= 0.0;
    unknown = unknown || itself;
    return chi > 0.0 && chi < kRoundsToOne * half ? std::string("floor")
                                                  : over(one, key, half) + (itself ? "*" : "");
  };
  size_t left_out = 0;
  for (const auto& one : step.at("raced")) {
    const std::string effect = one.at("effect");
    const json score = entry_of(scores, effect);
    const json refit = effect == added ? step : entry_of(rivals, effect);
    if (rows.size() > kMost && refit.is_null()) {
      ++left_out;
      continue;
    }
    rows.push_back({effect,
                    score.is_null() ? "-" : fmt::format("{:.1f}", number_in(score, "evidence")),
                    screened(one, "chi_fit"), screened(one, "chi_validate"),
                    refit.is_null() ? "" : over(refit, "chi_fit", floor),
                    refit.is_null() ? "" : over(refit, "chi_validate", floor),
                    refit.is_null()   ? ""
                    : effect == added ? "chosen"
                                      : fmt::format("{:.1f}", -number_in(refit, "score"))});
  }
  const size_t tried = rows.size();
  size_t untried = 0;
  for (const auto& score : scores) {
    const std::string effect = score.at("effect");
    if (number_in(score, "evidence") < limits.diagnosis.nameable ||
        !entry_of(step.at("raced"), effect).is_null())
      continue;
    ++untried;
    if (rows.size() <= kMost)
      rows.push_back(
          {effect, fmt::format("{:.1f}", number_in(score, "evidence")), "-", "", "", "", ""});
  }
  std::string text = table(rows);
  if (unknown)
    text += "  *: the residual itself, as the floor of the screening is not known here\n";
  if (left_out) text += fmt::format("  and {} more screened, not refitted\n", left_out);
  if (const size_t more = untried - (rows.size() - tried))
    text += fmt::format("  and {} of a smaller log BF, not screened\n", more);
  return text;
}

/// How far ahead of the next one: "how sure".
std::string sureness(const json& step, double floor, const Limits& limits,
                     const std::string& seen) {
  const std::string added = step.at("added");
  std::string nearest;
  double behind = 0.0;
  for (const auto& rival : step.value("rivals", json::array())) {
    const double by = -number_in(rival, "score");
    if (rival.at("effect") == added || (!nearest.empty() && by >= behind)) continue;
    nearest = rival.at("effect"), behind = by;
  }
  if (nearest.empty()) return "how sure: no other was refitted, all fell behind in the screening";
  if (behind < -limits.diagnosis.tie)
    return fmt::format("how sure: alone {} does better; {} was chosen with what the next step has",
                       nearest, added);
  if (behind < limits.diagnosis.tie)
    return fmt::format(
        "how sure: {} does as well (behind by {:.1f}){}", nearest, behind,
        seen == "photos" ? "; `hookeye plan RUN` tells which photos would separate the two" : "");
  const double left = floor > 0.0 ? number_in(step, "chi_fit") / floor : 0.0;
  if (left > limits.floor.at)
    return fmt::format(
        "how sure: {}, the next, is behind by {:.1f}; alone it leaves {:.2f} times "
        "the noise floor, more is missing",
        nearest, behind, left);
  // Tails of a likelihood are trusted as little as anyone's: beyond a million the number says
  // nothing.
  const std::string odds =
      behind > std::log(1e6) ? "more than a million" : fmt::format("{:.0f}", std::exp(behind));
  return fmt::format("how sure: {}, the next, is behind by {:.1f}: odds of {} to one", nearest,
                     behind, odds);
}

/// Who can change the photos as the added effect does, by the diagnosis before it. (Not whose
/// change it can imitate: gravity may bend a body as a pressure does, and stretch it besides.)
std::string resemblance(const json& before, const std::string& added, const std::string& seen) {
  const json score = entry_of(before.value("diagnosis", json::array()), added);
  if (!score.contains("confusion")) return "";
  std::vector<std::string> names;
  for (const auto& other : score.at("confusion"))
    if (names.size() < 4)
      names.push_back(fmt::format("{} {:.3f}", other.at("effect").get<std::string>(),
                                  number_in(other, "cosine")));
  return names.empty() ? fmt::format(
                             "; to first order no other changes these {} as it does "
                             "(cosines below 0.9)",
                             seen)
                       : fmt::format(
                             "; to first order these change the {} much as it does "
                             "(cosine 1: the same): {}",
                             seen, fmt::join(names, ", "));
}

/// What the step says of an effect, without its name; "": nothing.
std::string said_of(const json& step, const std::string& effect) {
  for (const std::string said : step.value("says", json::array()))
    if (said.starts_with(effect + ": ")) return said.substr(effect.size() + 2);
  return "";
}

/// An effect in another form than the step before has it: no choice between effects. "": it is not.
std::string other_form(const json& before, const json& step, double floor) {
  const std::string added = step.at("added");
  if (step.value("dropped", json::array()) != json::array({added})) return "";
  const std::string form = said_of(step, added);
  if (form.empty()) return "";
  const auto left = [&](const json& of) {
    return fmt::format("{} fitted, {} held out", times_floor(number_in(of, "chi_fit"), floor),
                       times_floor(number_in(of, "chi_validate"), floor));
  };
  return "\n" + wrapped(fmt::format(
                    "why {}, other parametrisation: {} (residual over noise floor: {}; before: {})",
                    added, form, left(step), left(before)));
}

bool by_hand(const json& step) {
  const std::string command = step.value("command", "");
  return command.find("hookeye add ") != std::string::npos ||
         command.find("hookeye studio ") != std::string::npos;
}

}  // namespace

std::string high_floor(const Floor& floor) {
  // Photos that other renderers took keep 1.1 to 2.4 times their noise (docs/benchmarks.md).
  constexpr double kUsual = 3.0;
  if (floor.source != "rest photos") return "";
  std::string of;
  double chi = floor.chi;
  for (const auto& [camera, own] : floor.by_camera)
    if (own > std::max(chi, kUsual)) of = fmt::format(" of camera '{}'", camera), chi = own;
  if (chi < kUsual) return "";
  return fmt::format(
      "the noise floor{0} itself is {1:.2f} times the specified noise: the reference images{0} are "
      "missed by something that no smooth motion or brightness explains, as blur, gloss, a texture "
      "that is off or noise that was specified too low. What is as large as that in every photo "
      "passes for noise here",
      of, chi);
}

std::string copied_floor(const Floor& floor) {
  if (floor.copies <= 0.0) return "";
  return fmt::format(
      "the reference images leave {:.2g} times the specified noise, less than the best model could "
      "leave of the loaded photos: they repeat the noise of what they are compared with, as stills "
      "of one video or strongly compressed photos do. The noise floor is that of the loaded photos",
      floor.copies);
}

std::string choice_table(const json& before, const json& step, double floor, const Limits& limits,
                         const std::string& seen) {
  if (step.at("added").is_null()) return "";
  const std::string added = step.at("added");
  if (by_hand(step))
    return "\n" + wrapped(fmt::format(
                      "{} was added by hand and not screened against others: `hookeye discover "
                      "CAPTURE -o NEW_RUN` tells what else it could have been{}",
                      added, resemblance(before, added, seen)));
  if (const std::string form = other_form(before, step, floor); !form.empty()) return form;
  const auto raced = step.value("raced", json::array());
  // A mesh that settles its step alone is no choice.
  if (raced.empty() || (raced.size() == 1 && numerical(added))) return "";
  return "\n" +
         wrapped(fmt::format(
             "why {}: normalised residual over the noise floor with each effect that stood out "
             "(screening: after one or two steps of a refit{}; floor: less than that; -: not "
             "screened, as it "
             "promised too little or had no equilibrium; blank: not refitted; behind: in the "
             "refits' penalised log likelihood, below {:.0f} is a tie)",
             added,
             seen == "photos" ? ", of photos at half size, over what those at rest kept of the "
                                "model before"
                              : ", over the floor",
             limits.diagnosis.tie)) +
         choice_rows(before, step, floor, limits) +
         wrapped(sureness(step, floor, limits, seen) + resemblance(before, added, seen), 2);
}

std::string not_converged(bool converged, int iterations) {
  if (converged) return {};
  return fmt::format(
      "the fit has not converged: the misfit still fell when it stopped after {} iterations, "
      "so that its values may move further",
      iterations);
}

}  // namespace hookeye
