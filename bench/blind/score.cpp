#include "bench/blind/score.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "bench/blind/draw.h"
#include "estimation/effects/catalogue.h"
#include "estimation/model/effect.h"

namespace hookeye::blind {

using nlohmann::json;

namespace {

double number(const json& object, const char* key) {
  return object.contains(key) && object[key].is_number() ? object[key].get<double>() : 0.0;
}

/// Distance from the floor that is left, as a share of what there was.
double left(double before, double after, double floor) {
  return before > floor ? std::max(0.0, after - floor) / (before - floor) : 0.0;
}

bool numerical(const std::string& name) {
  const Effect* effect = find_effect(name);
  return effect && effect->group() == EffectGroup::numerical;
}

/// Compares the values of one ingredient with the truth: nothing where a name is missing.
void compare(const json& found, const std::map<std::string, double>& truth,
             std::optional<double>* error, Score* out) {
  std::map<std::string, json> by_name;
  for (const json& one : found) by_name[one["name"]] = one;
  std::map<std::string, double> largest;  // by unit
  for (const auto& [name, value] : truth) {
    if (!by_name.count(name)) return;
    double& most = largest[by_name[name].value("unit", "")];
    most = std::max(most, std::abs(value));
  }
  for (const auto& [name, value] : truth) {
    const json& one = by_name[name];
    const double scale = largest[one.value("unit", "")];
    if (!(scale > 0.0)) continue;
    *error = std::max(error->value_or(0.0), std::abs(number(one, "value") - value) / scale);
    ++out->values;
    // an end that is no number is open
    const bool above = !one["low"].is_number() || value >= one["low"].get<double>();
    const bool below = !one["high"].is_number() || value <= one["high"].get<double>();
    out->inside += above && below;
  }
}

/// Every value of the base material that the run has fitted, and of every hidden effect.
void compare_values(const json& found, const json& truth, Score* out) {
  for (const auto& [name, values] : truth["material"].items())
    if (values.size() == 1) compare(found, {{name, values[0]}}, &out->material_error, out);
  for (const json& one : truth["hidden"])
    compare(found, one["values"].get<std::map<std::string, double>>(), &out->effect_error, out);
}

/// The middle one of several, [] of none.
std::optional<double> median(std::vector<double> values) {
  if (values.empty()) return {};
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

std::string cell(const std::optional<double>& value) {
  return value ? fmt::format("{:.5f}", *value) : "";
}

/// "?": the diagnosis that would tell failed.
std::string missed_cell(const Score& s) {
  if (s.explained_by_another() && !s.missed) return "?";
  return s.missed ? fmt::format("{}", fmt::join(*s.missed, " ")) : "";
}

}  // namespace

bool Score::right_first() const {
  if (left_out) return !explained_by_another();
  if (hidden == "none") return first == "none";
  const auto names = effects_of(hidden);
  return std::find(names.begin(), names.end(), first) != names.end();
}

bool Score::right_or_tie() const {
  if (right_first()) return true;
  const auto names = effects_of(hidden);
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return std::find(tie.begin(), tie.end(), name) != tie.end();
  });
}

bool Score::explained_by_another() const {
  return left_out && hidden != "none" && verdict != "unexplained" && first != "none";
}

bool Score::explained_by_double() const {
  return explained_by_another() && missed && missed->empty();
}

bool Score::exact_set() const {
  const auto names = effects_of(hidden);
  const std::set<std::string> asked(names.begin(), names.end());
  std::set<std::string> found;
  for (const std::string& name : added)
    if (!numerical(name) || asked.count(name)) found.insert(name);
  return found == asked;
}

std::vector<std::string> named_beside(const json& diagnosis,
                                      const std::vector<std::string>& effects) {
  std::vector<std::string> out;
  for (const json& one : diagnosis["effects"]) {
    const std::string name = one["effect"];
    if (one["named"] && std::find(effects.begin(), effects.end(), name) != effects.end())
      out.push_back(name);
  }
  return out;
}

Score score(const json& run, const json& truth) {
  Score out;
  out.hidden = "none";
  std::vector<std::string> hidden;
  for (const json& one : truth["hidden"]) hidden.push_back(one["effect"]);
  if (!hidden.empty()) {
    out.hidden = fmt::format("{}", fmt::join(hidden, "+"));
    out.hidden_px = truth["hidden"][0]["rms_px"];
  }
  out.verdict = run.value("verdict", "");
  out.floor = number(run["floor"], "chi");
  if (run.contains("tie")) out.tie = run["tie"].get<std::vector<std::string>>();
  const json& steps = run["steps"];
  out.added = run["missing"].get<std::vector<std::string>>();
  const bool mesh_hidden = !hidden.empty() && numerical(hidden[0]);
  for (const std::string& name : out.added)
    if (out.first == "none" && (mesh_hidden || !numerical(name))) out.first = name;
  out.fit_before = number(steps.front(), "chi_fit");
  out.fit_after = number(steps.back(), "chi_fit");
  out.held_before = number(steps.front(), "chi_validate");
  out.held_after = number(steps.back(), "chi_validate");
  compare_values(steps.back()["parameters"], truth, &out);
  return out;
}

std::string csv(const std::vector<Score>& scores) {
  std::string out =
      "hidden,seed,status,first,right_first,right_or_tie,exact_set,verdict,added,tie,hidden_px,"
      "floor,"
      "fit_before,fit_after,held_out_before,held_out_after,seconds,material_error,effect_error,"
      "values,inside,explained_by_another,missed\n";
  for (const Score& s : scores)
    out += fmt::format(
        "{},{},{},{},{:d},{:d},{:d},{},{},{},{:.3f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},"
        "{:.0f},{},{},{},{},{:d},{}\n",
        s.hidden, s.seed, s.status, s.first, s.right_first(), s.right_or_tie(), s.exact_set(),
        s.verdict, fmt::join(s.added, " "), fmt::join(s.tie, " "), s.hidden_px, s.floor,
        s.fit_before, s.fit_after, s.held_before, s.held_after, s.seconds, cell(s.material_error),
        cell(s.effect_error), s.values, s.inside, s.explained_by_another(), missed_cell(s));
  return out;
}

std::string summary(const std::vector<Score>& scores) {
  int guilty = 0, right = 0, tie = 0, exact = 0, finer = 0, innocent = 0, alarms = 0, failed = 0;
  int values = 0, inside = 0, good = 0, another = 0, doubles = 0;
  constexpr double kGoal = 1.15;
  std::vector<double> share, material, effect;
  for (const Score& s : scores) {
    finer += std::any_of(s.added.begin(), s.added.end(), numerical);
    if (s.status == "ok" && s.exact_set()) {  // another model has another truth
      values += s.values, inside += s.inside;
      if (s.material_error) material.push_back(*s.material_error);
      if (s.effect_error) effect.push_back(*s.effect_error);
    }
    if (s.status != "ok") {
      ++failed;
    } else if (s.hidden == "none") {
      ++innocent;
      alarms += s.first != "none";
    } else {
      ++guilty;
      right += s.right_first();
      tie += s.right_or_tie();
      another += s.explained_by_another();
      doubles += s.explained_by_double();
      exact += s.exact_set();
      good += s.exact_set() && s.held_after <= kGoal * s.floor;
      share.push_back(left(s.held_before, s.held_after, s.floor));
    }
  }
  const bool another_catalogue =
      std::any_of(scores.begin(), scores.end(), [](const Score& s) { return s.left_out; });
  std::string out = fmt::format(
      "{} {} of {}\nright or declared tie {} of {}\n"
      "exactly the hidden    {} of {}\n"
      "false alarms          {} of {} captures that hide nothing\n"
      "finer mesh asked for  {} of {}\nfailed                {}\n",
      another_catalogue ? "no other name explains" : "right name first     ", right, guilty, tie,
      guilty, exact, guilty, alarms, innocent, finer, scores.size(), failed);
  out +=
      fmt::format("held-out chi within {:g} times the floor: {} of {} where exactly the hidden\n",
                  kGoal, good, exact);
  if (another > 0)
    out += fmt::format("explained by another      {}; to the photos it is the same: {}\n", another,
                       doubles);
  if (const auto stays = median(share))
    out += fmt::format("held-out error over the floor that stays: {:.0f} % in the median\n",
                       100.0 * *stays);
  if (const auto error = median(material))
    out +=
        fmt::format("error of the material's values, where all is named: {:.2g} % in the median\n",
                    100.0 * *error);
  if (const auto error = median(effect))
    out += fmt::format("error of the effect's values: {:.2g} % in the median\n", 100.0 * *error);
  if (values > 0)
    out += fmt::format("true values inside their 95 % intervals: {} of {}\n", inside, values);
  return out;
}

std::string table(const std::vector<Score>& scores) {
  struct Row {
    int captures = 0, right = 0, exact = 0;
    std::vector<double> px, before, after;
  };
  std::map<std::string, Row> rows;
  for (const Score& s : scores) {
    if (s.status != "ok") continue;
    Row& row = rows[s.hidden];
    ++row.captures, row.right += s.right_first(), row.exact += s.exact_set();
    if (s.hidden_px > 0.0) row.px.push_back(s.hidden_px);
    row.before.push_back(s.held_before / s.floor), row.after.push_back(s.held_after / s.floor);
  }
  std::string out =
      "| hidden | moves by (rms) | right first | just it | held-out chi over the floor: before | "
      "after |\n|---|---|---|---|---|---|\n";
  for (const auto& [hidden, row] : rows) {
    const auto [least, most] = std::minmax_element(row.px.begin(), row.px.end());
    out += fmt::format("| {} | {} | {} of {} | {} of {} | {:.1f} | {:.2f} |\n", hidden,
                       row.px.empty() ? "–" : fmt::format("{:.2g} .. {:.2g} px", *least, *most),
                       row.right, row.captures, row.exact, row.captures, *median(row.before),
                       *median(row.after));
  }
  return out;
}

namespace {

/// What a capture was taken for: the names in its last model, numerical ones only where hidden, and
/// those that a declared tie has beside them.
std::set<std::string> taken_for(const Score& s, bool* tied) {
  const auto hidden = effects_of(s.hidden);
  std::set<std::string> names;
  for (const std::string& name : s.added)
    if (!numerical(name) || std::find(hidden.begin(), hidden.end(), name) != hidden.end())
      names.insert(name);
  *tied = !s.tie.empty();
  names.insert(s.tie.begin(), s.tie.end());
  if (names.empty()) names.insert("none");
  return names;
}

struct Cell {
  int count = 0, tied = 0;
};

/// Blue: hidden and named; red: named and not hidden; the paler the rarer, and paler where tied.
std::string cell_svg(int x, int y, int size, const Cell& cell, int total, bool right) {
  const double share = (cell.count - 0.5 * cell.tied) / total;
  const int pale = static_cast<int>(235 - 165 * share);
  const std::string fill = !cell.count ? "#fff"
                           : right     ? fmt::format("rgb({},{},{})", pale, pale + 10, 245)
                                       : fmt::format("rgb({},{},{})", 245, pale, pale);
  std::string out = fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\" stroke=\"#ccc\"/>\n", x, y,
      size, size, fill);
  if (cell.count)
    out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" fill=\"{}\">{}{}</text>\n",
                       x + size / 2, y + size / 2 + 4, share > 0.6 ? "#fff" : "#000", cell.count,
                       cell.tied ? "=" : "");
  return out;
}

}  // namespace

std::string confusion_svg(const std::vector<Score>& scores) {
  std::set<std::string> hidden, columns;
  std::map<std::pair<std::string, std::string>, Cell> cells;
  std::map<std::string, int> total;
  for (const Score& s : scores) {
    if (s.status != "ok") continue;
    hidden.insert(s.hidden);
    for (const std::string& name : effects_of(s.hidden)) columns.insert(name);
    ++total[s.hidden];
    bool tied = false;
    for (const std::string& name : taken_for(s, &tied)) {
      columns.insert(name);
      Cell& cell = cells[{s.hidden, name}];
      ++cell.count, cell.tied += tied;
    }
  }
  const int size = 26, left_margin = 210, top = 190;
  const int width = left_margin + static_cast<int>(columns.size()) * size + 120;
  const int height = top + static_cast<int>(hidden.size()) * size + 40;
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" "
      "fill=\"white\"/>\n<text x=\"8\" y=\"{}\">hidden (rows), named (columns); blue: right, red: "
      "wrong; =: in a declared tie</text>\n",
      std::max(width, 480), height, height - 12);
  int i = 0;
  for (const std::string& name : columns)
    out += fmt::format("<text transform=\"translate({},{}) rotate(-60)\">{}</text>\n",
                       left_margin + i++ * size + size / 2 + 4, top - 8, name);
  int row = 0;
  for (const std::string& name : hidden) {
    const int y = top + row++ * size;
    out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n", left_margin - 8,
                       y + size / 2 + 4, name);
    const auto names = effects_of(name);
    int column = 0;
    for (const std::string& named : columns) {
      const bool right = names.empty()
                             ? named == "none"
                             : std::find(names.begin(), names.end(), named) != names.end();
      const auto found = cells.find({name, named});
      out += cell_svg(left_margin + column++ * size, y, size,
                      found == cells.end() ? Cell{} : found->second, total[name], right);
    }
  }
  return out + "</svg>\n";
}

}  // namespace hookeye::blind
