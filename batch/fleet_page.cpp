#include "batch/fleet_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "batch/fleet_style.h"
#include "batch/strip_plot.h"
#include "runs/text.h"

namespace hookeye {
namespace {

using nlohmann::json;
using Rows = std::vector<json>;

std::string text_in(const json& row, const char* key) {
  return row.at(key).is_string() ? row.at(key).get<std::string>() : "";
}

double number_at(const json& row, const char* key) {
  return row.at(key).is_number() ? row.at(key).get<double>() : 0.0;
}

bool is_done(const json& row) { return row.at("state") == "done"; }

std::string linked(const json& row) {
  const std::string label = html_text(text_in(row, "label")), link = text_in(row, "report");
  return link.empty() ? label : fmt::format("<a href=\"{}\">{}</a>", html_text(link), label);
}

/// Misfit of the newest step in multiples of the noise floor, on fitted or on held-out photos,
/// where it is larger; 0: not known.
double over_floor(const json& row) {
  const double floor = number_at(row, "floor");
  return floor > 0.0 ? std::max(number_at(row, "chi_fit"), number_at(row, "chi_validate")) / floor
                     : 0.0;
}

const char* class_of(const std::string& verdict) {
  return verdict == "explained"                               ? "explained"
         : verdict == "unexplained" || verdict == "ambiguous" ? "doubt"
                                                              : "";
}

std::string times_text(double seconds) {
  if (seconds < 100.0) return fmt::format("{:.1f} s", seconds);
  if (seconds < 6000.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

std::string counts_list(const Rows& rows) {
  std::map<std::string, int> states, verdicts;
  double seconds = 0.0;
  for (const json& row : rows) {
    ++states[row.at("state")];
    seconds += number_at(row, "cpu_seconds");
    if (is_done(row) && row.at("verdict").is_string()) ++verdicts[row.at("verdict")];
  }
  std::string out = fmt::format("<ul class=\"counts\"><li><b>{}</b>captures</li>", rows.size());
  const auto add = [&](const char* kind, int count, const std::string& words) {
    if (count) out += fmt::format("<li class=\"{}\"><b>{}</b>{}</li>", kind, count, words);
  };
  for (const char* known : {"explained", "ambiguous", "unexplained"})
    add(class_of(known), verdicts[known], known);
  for (const auto& [verdict, count] : verdicts)
    if (*class_of(verdict) == 0) add("", count, html_text(verdict));
  if (verdicts.empty()) add("", states["done"], "done");
  add("failed", states["failed"], "<a class=\"failed\" href=\"#failed\">failed</a>");
  add("", states["leased"], "at work");
  add("", states["todo"], "to do");
  return out + fmt::format("<li><b>{}</b>of processors</li></ul>", times_text(seconds));
}

/// Who has it: named alone, and named together with others that cannot be told from it.
struct EffectCount {
  int alone = 0, tied = 0;
  std::string links;
};

std::string effect_row(const std::string& name, const char* kind, const EffectCount& count,
                       int all) {
  const double alone = 100.0 * count.alone / all, tied = 100.0 * count.tied / all;
  return fmt::format(
      "<details><summary><span class=\"name\">{}</span><svg aria-hidden=\"true\">"
      "<rect class=\"track\" width=\"100%\" height=\"14\" rx=\"2\"/>"
      "<rect class=\"fill {}\" width=\"{:.2f}%\" height=\"14\" rx=\"2\"/>"
      "<rect class=\"fill tied\" x=\"{:.2f}%\" width=\"{:.2f}%\" height=\"14\"/></svg>"
      "<span class=\"number\">{} of {}</span></summary><p>{}</p></details>",
      html_text(name), kind, alone, alone, tied, count.alone + count.tied, all, count.links);
}

std::string effects_section(const Rows& rows) {
  std::map<std::string, EffectCount> effects;
  EffectCount nothing, untold;
  int judged = 0;
  const auto count = [](EffectCount& one, const json& row, bool tied) {
    ++(tied ? one.tied : one.alone);
    one.links += (one.links.empty() ? "" : ", ") + linked(row);
  };
  for (const json& row : rows) {
    if (!is_done(row) || !row.at("verdict").is_string()) continue;
    const std::string verdict = row.at("verdict");
    if (*class_of(verdict) == 0) continue;  // a fit alone judges nothing
    ++judged;
    const json& tie = row.at("tie");
    for (const json& effect : row.at("found"))
      if (std::find(tie.begin(), tie.end(), effect) == tie.end())
        count(effects[effect], row, false);
    for (const json& effect : tie) count(effects[effect], row, true);
    if (verdict == "unexplained")
      count(untold, row, false);
    else if (row.at("found").empty() && tie.empty())
      count(nothing, row, false);
  }
  if (!judged) return {};
  std::vector<std::pair<std::string, EffectCount>> sorted(effects.begin(), effects.end());
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
    return a.second.alone + a.second.tied > b.second.alone + b.second.tied;
  });
  std::string out = "<section><h2>What the given models lack</h2><div class=\"effects\">";
  for (const auto& [name, one] : sorted) out += effect_row(name, "", one, judged);
  if (nothing.alone) out += effect_row("nothing missing", "none", nothing, judged);
  if (untold.alone) out += effect_row("not explained", "untold", untold, judged);
  return out +
         "</div><p class=\"soft\">Click a line for its captures. Pale: the photos cannot tell "
         "it from another effect.</p></section>";
}

/// Points of a parameter in all captures.
struct ParameterStrip {
  std::string name, unit, words;
  std::vector<StripPoint> points;
};

StripPoint point_of(const json& row, double value, double low, double high) {
  return {value,
          low,
          high,
          text_in(row, "label"),
          text_in(row, "report"),
          text_in(row, "verdict") != "unexplained" && text_in(row, "verdict") != "ambiguous"};
}

/// In the order in which they are met: the material's before those of effects.
std::vector<ParameterStrip> parameter_strips(const Rows& rows) {
  std::vector<ParameterStrip> out;
  std::map<std::pair<std::string, std::string>, size_t> places;
  for (const json& row : rows) {
    if (!is_done(row)) continue;
    for (const json& one : row.at("parameters")) {
      if (!one.at("value").is_number()) continue;
      const std::string name = one.at("name"), unit = text_in(one, "unit");
      const auto [place, first] = places.try_emplace({name, unit}, out.size());
      if (first) out.push_back({name, unit, text_in(one, "long_name"), {}});
      const double value = one.at("value");
      const bool open = !one.at("low").is_number() || !one.at("high").is_number();
      out[place->second].points.push_back(point_of(row, value, open ? value : number_at(one, "low"),
                                                   open ? value : number_at(one, "high")));
    }
  }
  return out;
}

std::string plot(const std::string& name, const std::string& unit, const std::string& words,
                 std::vector<StripPoint> points, std::vector<std::string>& outliers) {
  mark_outliers(points);
  std::vector<double> values;
  for (const StripPoint& one : points) values.push_back(one.value);
  const double middle = median_of(values);
  for (const StripPoint& one : points) {
    if (!one.outlier) continue;
    const std::string label = html_text(one.label);
    outliers.push_back(fmt::format(
        "{}: {} = {:.5g} {} (median {:.5g})",
        one.link.empty() ? label : fmt::format("<a href=\"{}\">{}</a>", html_text(one.link), label),
        html_text(name), one.value, html_text(unit), middle));
  }
  return fmt::format(
      "<div><h3>{} <small>{}</small></h3><p>{}{} capture{}, median {:.5g} {}</p>{}</div>",
      html_text(name), html_text(unit), words.empty() ? "" : html_text(words) + "; ", points.size(),
      points.size() == 1 ? "" : "s", middle, html_text(unit), strip_plot(points, unit));
}

std::string plots_section(const Rows& rows) {
  std::vector<std::string> outliers;
  std::string plots;
  for (const ParameterStrip& one : parameter_strips(rows))
    plots += plot(one.name, one.unit, one.words, one.points, outliers);
  std::vector<StripPoint> misfits;
  for (const json& row : rows)
    if (const double times = over_floor(row); is_done(row) && times > 0.0)
      misfits.push_back(point_of(row, times, times, times));
  if (!misfits.empty())
    plots +=
        plot("misfit", "", "the larger of fitted and held-out, over the noise floor; 1 is noise",
             misfits, outliers);
  if (plots.empty()) return {};
  std::string far;
  for (const std::string& one : outliers) far += "<li>" + one + "</li>";
  return "<section><h2>Values with 95 % intervals</h2><div class=\"plots\">" + plots +
         "</div><p class=\"soft\">A row a capture, sorted; click it for its report. Dashed: the "
         "median. Hollow: not explained, or ambiguous.</p></section>" +
         (far.empty() ? "" : "<section><h2>Far from the others</h2><ul>" + far + "</ul></section>");
}

std::string failures_section(const Rows& rows) {
  std::string lines;
  for (const json& row : rows)
    if (row.at("state") == "failed")
      lines += fmt::format(
          "<tr><td>{}</td><td class=\"value\">{}</td><td class=\"line\"><code>{}</code></td>"
          "<td><a href=\"{}\">log</a></td></tr>",
          linked(row), row.at("exit").dump(), html_text(text_in(row, "error")),
          html_text(text_in(row, "log")));
  if (lines.empty()) return {};
  return "<section id=\"failed\"><h2 class=\"failed\">Failed</h2><div class=\"wide\" "
         "tabindex=\"0\"><table><tr>"
         "<th>capture</th><th class=\"value\">exit status</th><th>what it said</th><th></th></tr>" +
         lines + "</table></div></section>";
}

std::string named_in(const json& row) {
  std::string out;
  const json& tie = row.at("tie");
  for (const json& effect : row.at("found"))
    if (std::find(tie.begin(), tie.end(), effect) == tie.end())
      out += (out.empty() ? "" : ", ") + effect.get<std::string>();
  std::string either;
  for (const json& effect : tie)
    either += (either.empty() ? "" : " or ") + effect.get<std::string>();
  return out + (out.empty() || either.empty() ? "" : ", ") + either;
}

std::string table_row(const json& row) {
  const std::string verdict = text_in(row, "verdict"), state = text_in(row, "state");
  const double times = over_floor(row), memory = number_at(row, "memory");
  return fmt::format(
      "<tr><td title=\"{}\">{}</td><td class=\"{}\" title=\"{}\">{}</td><td>{}</td>"
      "<td class=\"value\">{}</td><td class=\"value\">{}</td><td class=\"value\">{}</td></tr>",
      html_text(text_in(row, "capture")), linked(row),
      state == "failed" ? "failed" : class_of(verdict), html_text(text_in(row, "sentence")),
      html_text(is_done(row) && !verdict.empty() ? verdict : state), html_text(named_in(row)),
      times > 0.0 ? fmt::format("{:.2f}", times) : "",
      row.at("seconds").is_number() ? times_text(number_at(row, "seconds")) : "",
      memory > 0.0 ? fmt::format("{:.0f} MB", 1e-6 * memory) : "");
}

std::string all_section(const Rows& rows) {
  std::string lines;
  for (const json& row : rows) lines += table_row(row);
  return "<section><h2>All captures</h2><div class=\"wide\" tabindex=\"0\"><table><tr><th>capture"
         "</th><th>verdict</th><th>lacks</th><th class=\"value\">over floor</th>"
         "<th class=\"value\">time</th><th class=\"value\">memory</th></tr>" +
         lines + "</table></div></section>";
}

}  // namespace

std::string fleet_page(const Rows& rows, const BatchOrder& order) {
  std::string command = order.verb;
  for (const std::string& word : order.options) command += " " + word;
  return fmt::format(
             "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>"
             "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>"
             "<meta name=\"color-scheme\" content=\"light dark\"/>"
             "<meta name=\"referrer\" content=\"no-referrer\"/>"
             "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
             "style-src 'sha256-{}'; base-uri 'none'; form-action 'none'\"/>"
             "<title>Hookeye: {} captures</title><style>{}</style></head><body>",
             kFleetStyleHash, rows.size(), kFleetStyle) +
         fmt::format(
             "<header><h1>Batch of {} captures</h1><span class=\"soft\">each by "
             "<code>hookeye {}</code></span></header>",
             rows.size(), html_text(command)) +
         counts_list(rows) + effects_section(rows) + plots_section(rows) + failures_section(rows) +
         all_section(rows) +
         fmt::format(
             "<footer>hookeye {}. The same rows: <a href=\"index.csv\">index.csv</a>, "
             "<a href=\"index.sqlite\">index.sqlite</a>.</footer></body></html>\n",
             html_text(order.version));
}

}  // namespace hookeye
