#include "runs/report/answer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "capture_io/seen_in_words.h"
#include "core/json_file.h"
#include "core/text_file.h"
#include "estimation/diagnosis/diagnosis.h"
#include "estimation/fit/at_floor.h"
#include "estimation/output/pixels_json.h"
#include "estimation/search/verdict.h"
#include "runs/report/effect_values.h"
#include "runs/report/inside.h"
#include "runs/report/met_values.h"
#include "runs/run_limits.h"
#include "runs/tables.h"
#include "runs/text.h"

namespace hookeye {

using nlohmann::json;

namespace {

using Names = std::vector<std::string>;

/// "a, b and c".
std::string listed(const Names& names) {
  if (names.size() < 2) return fmt::format("{}", fmt::join(names, ""));
  return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

std::string capital(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

Names strings_in(const json& object, const char* key) {
  Names out;
  if (!object.is_object() || !object.contains(key) || !object[key].is_array()) return out;
  for (const json& one : object[key])
    if (one.is_string()) out.push_back(one);
  return out;
}

std::string string_in(const json& object, const char* key) {
  return object.is_object() && object.contains(key) && object[key].is_string()
             ? object[key].get<std::string>()
             : "";
}

/// seen_in_words() of the capture whose figures these are.
const char* what_is_seen(const json& metrics) {
  if (!metrics.is_object() || !metrics.contains("photos")) return seen_in_words(true, false);
  return seen_in_words(!metrics["photos"].empty(), !metrics.value("fields", json::array()).empty());
}

/// The newest step against the noise floor.
struct Left {
  std::string seen;                     ///< "photos", "fields" or "values"
  double fitted = 0.0, held_out = 0.0;  ///< times the floor; 0: nothing is held out
  double limit = 0.0;                   ///< times the floor that count as explained
  bool at_floor = false;                ///< all photos together
  bool on_floor = false;                ///< no more than renderers leave at least
  std::string one_camera;               ///< ", but ..." where one alone is not
  /// Views are planned by cameras alone.
  const char* planned(const char* hint) const { return seen == "photos" ? hint : ""; }
  /// "1.04 times the noise floor (1.03 on held-out photos)".
  std::string text() const {
    return fmt::format(
        "{:.2f} times the noise floor{}", fitted,
        held_out > 0.0 ? fmt::format(" ({:.2f} on held-out {})", held_out, seen) : "");
  }
};

double floor_of(const json& timeline, const json& metrics) {
  for (const json* of : {&timeline, &metrics})
    if (of->is_object() && of->contains("floor") && number_in((*of)["floor"], "chi") > 0.0)
      return number_in((*of)["floor"], "chi");
  return 1.0;
}

Left left_of(const json& step, const json& metrics, double floor, const Limits& limits) {
  Left out;
  out.seen = what_is_seen(metrics);
  out.on_floor = std::max(number_in(step, "chi_fit"), number_in(step, "chi_validate")) <=
                 limits.floor.on * floor;
  out.fitted = number_in(step, "chi_fit") / floor;
  out.held_out = number_in(step, "chi_validate") / floor;
  out.limit = limits.floor.at;
  out.at_floor = std::max(out.fitted, out.held_out) <= out.limit;
  const json most = metrics.is_object() ? metrics.value("most_over_floor", json()) : json();
  if (out.at_floor && most.is_object() && most.value("its_own", false))
    out.one_camera = fmt::format(
        ", but {:.2f} times its own in the {} photos of camera '{}'", number_in(most, "times"),
        string_in(most, "use") == "fit" ? "fitted" : "held-out", string_in(most, "camera"));
  return out;
}

/// "gravity (self-weight, 9.8 (9.7 to 9.9) m/s2 towards (0.15, 0.09, -0.98))", as the step says it.
std::string with_words(const std::string& effect, const json& step) {
  for (const std::string& said : strings_in(step, "says"))
    if (said.starts_with(effect + ": "))
      return fmt::format("{} ({})", effect, said.substr(effect.size() + 2));
  return effect;
}

std::string explains(const std::string& what, const Left& left) {
  return left.on_floor ? fmt::format("{} explains the {} down to their noise", what, left.seen)
                       : fmt::format("{} explains the {} to {}", what, left.seen, left.text());
}

/// What `discover` found, in plain words; empty where these words would not do.
std::optional<std::string> judged_sentence(const json& timeline, const json& step,
                                           const Left& left) {
  const std::string verdict = string_in(timeline, "verdict");
  const Names tie = strings_in(timeline, "tie");
  Names found, mesh;
  for (const std::string& name : strings_in(timeline, "missing")) {
    if (numerical(name))
      mesh.push_back(name);
    else if (!tie.empty() && name == tie.front())
      found.push_back(fmt::format("either {}", fmt::join(tie, " or ")));
    else
      found.push_back(with_words(name, step));
  }
  const std::string on = mesh.empty() ? "" : " on a finer mesh";
  const std::string with = found.size() == 1 ? "With it" : "With them";
  if (verdict == "unexplained") {
    if (left.at_floor) return std::nullopt;  // sensors, or one camera: the long sentence says which
    if (const Names untold = strings_in(timeline, "untold"); !untold.empty())
      return fmt::format(
          "{}These {} cannot tell what {}is missing: {} is left, and {} stand{} out by more "
          "than chance, but not by enough to be named{}",
          found.empty() ? "" : capital(listed(found)) + " is missing, but it is not enough. ",
          left.seen, found.empty() ? "" : "else ", left.text(), any_of_them(untold),
          untold.size() > 1 ? "" : "s",
          left.planned(" (`hookeye plan RUN` names views and loads that can tell)"));
    if (!found.empty() && left.held_out > left.limit && left.fitted <= left.limit)
      return fmt::format(
          "{} {} missing. {} explains the fitted {} ({:.2f} times the noise floor), but not yet "
          "the "
          "held-out ones ({:.2f}; up to {:g} counts as explained)",
          capital(listed(found)), found.size() == 1 ? "is" : "are",
          found.size() == 1 ? "It" : "Together that", left.seen, left.fitted, left.held_out,
          left.limit);
    return found.empty()
               ? fmt::format("No effect of the catalogue explains what is left{}: {}", on,
                             left.text())
               : fmt::format(
                     "{} {} missing, but {} not enough: {} {} left, and nothing else of the "
                     "catalogue explains it",
                     capital(listed(found)), found.size() == 1 ? "is" : "are",
                     found.size() == 1 ? "it is" : "they are", left.text(), "is");
  }
  if (found.empty()) {
    const bool refused = string_in(timeline, "sentence").starts_with("nothing that is missing");
    return fmt::format("{}: {}",
                       refused ? "Nothing that was tested pays for itself" : "Nothing is missing",
                       explains("the given model" + on, left));
  }
  return fmt::format("The given model lacks {}{}. {}", listed(found),
                     verdict == "ambiguous"
                         ? fmt::format("; these {} cannot tell which{}", left.seen,
                                       left.planned(" (`hookeye plan RUN` names some that can)"))
                         : "",
                     explains(verdict == "ambiguous" ? "With one of them" + on + " the model"
                                                     : with + on + " the model",
                              left));
}

/// What the newest diagnosis concludes, in its own words; where its file is not there, by what the
/// timeline has of it.
std::string concluded(const json& step, const json& diagnosis) {
  if (const std::string own = string_in(diagnosis, "conclusion"); !own.empty()) return own;
  const json effects = diagnosis.is_object() ? diagnosis.value("effects", json::array())
                                             : step.value("diagnosis", json::array());
  Names named;
  for (const json& one : effects)
    if (one.is_object() && one.value("named", false)) named.push_back(string_in(one, "effect"));
  return named.empty() ? "nothing of the catalogue stands out"
                       : fmt::format("{} stand{} out as missing", listed(named),
                                     named.size() == 1 ? "s" : "");
}

/// Of a step that nobody has judged.
void judge_by_figures(const json& step, const json& diagnosis, const Left& left, json& out) {
  const Names effects = strings_in(step, "effects");
  const std::string model =
      effects.empty() ? "The given model" : fmt::format("The model with {}", listed(effects));
  const std::string leaves =
      fmt::format("{} leaves {}{}{}", model, left.text(), left.one_camera,
                  left.at_floor ? "" : ": until that is explained, values and intervals mislead");
  const bool tested = diagnosis.is_object() || !step.value("diagnosis", json::array()).empty();
  const bool done = left.at_floor && left.one_camera.empty();
  out["headline"] = !tested ? "not judged yet"
                    : done  ? "at the noise floor"
                            : "above the noise floor";
  if (!tested) {
    out["sentence"] =
        leaves +
        ". What may be missing has not been tested (`hookeye diagnose RUN`, or `discover`)";
    return;
  }
  out["sentence"] = leaves + ". " + capital(concluded(step, diagnosis));
}

std::string misfit_sentence(const json& step, const json& metrics, double floor,
                            const std::string& source) {
  const double held_out = number_in(step, "chi_validate"), px = number_in(step, "rms_px_fit");
  std::string out = fmt::format("normalised residual {:.3f} on fitted {}",
                                number_in(step, "chi_fit"), what_is_seen(metrics));
  if (held_out > 0.0) out += fmt::format(", {:.3f} on held-out ones", held_out);
  out += fmt::format("; noise floor {:.3f}{}", floor,
                     source == "rest photos"     ? " (reference images)"
                     : source == "loaded photos" ? " (what no model could take from the photos)"
                     : source == "rest fields"   ? " (fields at rest)"
                     : source == "loaded fields" ? " (what is rough in the fields)"
                     : source.empty()            ? ""
                                                 : " (" + source + ")");
  if (px > 0.0) out += fmt::format("; surface off by {:.2g} px", px);
  return out + met_values(metrics);
}

/// What is left where nothing chose; or that held-out photos helped to choose.
std::string tested_sentence(const json& timeline, const json& step, double floor) {
  const json tested = timeline.value("tested", json());
  if (tested.is_object()) {
    const json examples = tested.value("examples", json::array());
    const double chi = number_in(tested, "chi");
    double worst = 0.0;
    for (const json& one : examples) worst = std::max(worst, number_in(one, "measured_over_sigma"));
    Names names;
    for (const json& one : examples) names.push_back(string_in(one, "name"));
    std::string out = fmt::format("on {}, which no fit, score or stop has seen: ", listed(names));
    if (chi > 0.0) out += fmt::format("{:.2f} times the noise floor", chi / floor);
    if (const double at = limits_of(timeline).floor.at; chi > at * floor)
      out += fmt::format(", more than {:g}: what was found does not predict it", at);
    if (worst > 0.0)
      out += fmt::format("{}measured values within {:.2g} of their sigma", chi > 0.0 ? ", " : "",
                         worst);
    return out;
  }
  if (!timeline.contains("sentence") || number_in(step, "chi_validate") <= 0.0) return "";
  return "held-out examples helped to choose the effects: only one of `use: test` has no part in "
         "it";
}

json material_in(const json& metrics, const json& diagnosis) {
  for (const json* of : {&diagnosis, &metrics})
    if (of->is_object() && of->contains("material") && (*of)["material"].is_object())
      return (*of)["material"];
  return {};
}

json file_of(const std::filesystem::path& run, const std::filesystem::path& file) {
  std::string damage;
  if (!inside(run, file)) return {};
  const auto found = parse_json(read_text(file), damage);
  return found && found->is_object() ? *found : json();
}

}  // namespace

json answer_of(const json& timeline, const json& metrics, const json& diagnosis) {
  json out = {{"material", material_in(metrics, diagnosis)},
              {"headline", "not judged yet"},
              {"sentence", "No step is finished"},
              {"misfit", ""},
              {"pixels", ""},
              {"tested", ""},
              {"effects", json::array()}};
  const json steps = timeline.is_object() ? timeline.value("steps", json::array()) : json::array();
  if (steps.empty() || !steps.back().is_object()) return out;
  const json& step = steps.back();
  out["effects"] = effect_values(step);
  const double floor = floor_of(timeline, metrics);
  const Left left = left_of(step, metrics, floor, limits_of(timeline));
  if (timeline.contains("sentence")) {
    out["headline"] = string_in(timeline, "verdict");
    out["sentence"] =
        judged_sentence(timeline, step, left).value_or(capital(string_in(timeline, "sentence")));
  } else {
    judge_by_figures(step, diagnosis, left, out);
  }
  out["tested"] = tested_sentence(timeline, step, floor);
  const json told = timeline.contains("floor") ? timeline["floor"] : json::object();
  out["pixels"] = all_pixels_in_words(step.value("all_pixels", json()));
  out["misfit"] = misfit_sentence(step, metrics, floor, string_in(told, "source"));
  return out;
}

std::string seen_in_step(const std::filesystem::path& run, const std::filesystem::path& step) {
  return what_is_seen(file_of(run, step / "metrics.json"));
}

json answer_of(const std::filesystem::path& run, const json& timeline) {
  const json steps = timeline.value("steps", json::array());
  if (steps.empty()) return answer_of(timeline, {}, {});
  const std::filesystem::path newest =
      run / "steps" /
      fmt::format("{:02}-{}", steps.size() - 1, steps.back().at("name").get<std::string>());
  return answer_of(timeline, file_of(run, newest / "metrics.json"),
                   file_of(run, newest / "diagnosis.json"));
}

namespace {

std::string interval_of(const json& one) {
  const std::string known = string_in(one, "known");
  if (one.contains("low") && one.contains("high"))
    return fmt::format("{:.5g} .. {:.5g}", number_in(one, "low"), number_in(one, "high"));
  return known == "open" ? "not identifiable" : "as given";
}

void add_rows(const json& list, std::vector<std::vector<std::string>>& rows) {
  for (const json& one : list)
    rows.push_back({string_in(one, "name"), fmt::format("{:.5g}", number_in(one, "value")),
                    interval_of(one), string_in(one, "unit"), string_in(one, "long_name")});
}

}  // namespace

std::string material_text(const json& material) {
  if (!material.is_object()) return "";
  constexpr size_t kMost = 12;
  std::string text;
  for (const json& card : material.value("cards", json::array())) {
    const std::string region = string_in(card, "region");
    text += fmt::format("material{}: {}\n", region.empty() ? "" : " '" + region + "'",
                        string_in(card, "law"));
    const json own = card.value("parameters", json::array());
    std::vector<std::vector<std::string>> rows = {
        {"parameter", "value", "95 % interval", "unit", ""}};
    if (own.size() <= kMost) add_rows(own, rows);
    add_rows(card.value("small_strain", json::array()), rows);
    if (rows.size() > 1) text += table(rows);
    if (own.size() > kMost)
      text += fmt::format("  and {} control values: the step's model.yaml has them\n", own.size());
  }
  if (const Names beside = strings_in(material, "beside"); !beside.empty())
    text += wrapped("the law's own values are without " + listed(beside) +
                        ", which the body has too; means over the body are with it",
                    2);
  for (const std::string& sentence : strings_in(material, "depends")) text += wrapped(sentence, 2);
  return text;
}

std::string answer_text(const json& answer) {
  const std::string headline = string_in(answer, "headline"), misfit = string_in(answer, "misfit"),
                    tested = string_in(answer, "tested"), pixels = string_in(answer, "pixels");
  return material_text(answer.at("material")) +
         wrapped(fmt::format("verdict: {}. {}", headline, string_in(answer, "sentence"))) +
         (misfit.empty() ? "" : wrapped("misfit: " + misfit)) +
         (pixels.empty() ? "" : wrapped("pixels: " + pixels)) +
         (tested.empty() ? "" : wrapped("test: " + tested));
}

}  // namespace hookeye
