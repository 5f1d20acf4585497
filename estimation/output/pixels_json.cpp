#include "estimation/output/pixels_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hookeye {

using nlohmann::json;

json readings_json(const PhotoReadings& readings) {
  json out = json::object();
  for (const auto& [camera, reading] : readings) {
    const PhotoWindow& window = reading.window;
    out[camera] = {{"width_over", 1 << reading.halvings},
                   {"motion_kept", reading.kept},
                   {"tiles", reading.share},
                   {"body_px", reading.body_px}};
    if (!window.empty()) out[camera]["window"] = {window.x, window.y, window.width, window.height};
  }
  return out;
}

json all_pixels_json(const Fitted& fitted) {
  const AllPixels& all = *fitted.all_pixels;
  const auto parameters = fitted.form.parameters();
  json rows = json::array();
  for (size_t i = 0; i < parameters.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    rows.push_back({{"name", parameters[i].name},
                    {"value", all.value[k]},
                    {"moved", all.value[k] - fitted.p[k]},
                    {"standard_error", all.error[k]},
                    {"standard_error_read", all.read_error[k]},
                    {"added_by_reading", all.added[k]}});
  }
  return {{"share", all.share},
          {"pixels", all.pixels},
          {"read_pixels", all.read_pixels},
          {"chi_fit", all.chi_fit},
          {"chi_validate", all.chi_validate > 0.0 ? json(all.chi_validate) : json()},
          {"parameters", std::move(rows)}};
}

std::optional<AllPixels> all_pixels_in(const json& told, const std::vector<Parameter>& parameters) {
  if (!told.is_object()) return {};
  const json rows = told.value("parameters", json::array());
  if (rows.size() != parameters.size()) return {};
  const auto n = static_cast<Eigen::Index>(parameters.size());
  AllPixels out{VectorXd(n), VectorXd(n), VectorXd(n), VectorXd(n)};
  try {
    for (Eigen::Index i = 0; i < n; ++i) {
      const json& row = rows[static_cast<size_t>(i)];
      if (row.at("name") != parameters[static_cast<size_t>(i)].name) return {};
      out.value[i] = row.at("value"), out.error[i] = row.at("standard_error");
      out.read_error[i] = row.at("standard_error_read");
      out.added[i] = row.at("added_by_reading");
    }
    out.share = told.at("share");
    out.pixels = told.at("pixels"), out.read_pixels = told.at("read_pixels");
    out.chi_fit = told.at("chi_fit");
    if (told.at("chi_validate").is_number()) out.chi_validate = told.at("chi_validate");
  } catch (const json::exception&) {
    return {};  // a number that is none
  }
  return out;
}

namespace {

/// The row for which it is largest; nullptr: none.
template <class Value>
const json* most(const json& rows, const Value& value) {
  const json* out = nullptr;
  for (const json& row : rows)
    if (row.value("standard_error", 0.0) > 0.0 && (!out || value(row) > value(*out))) out = &row;
  return out;
}

double moved_of_error(const json& row) {
  return std::abs(row.value("moved", 0.0)) / row.value("standard_error", 1.0);
}

/// Of the standard error: sqrt(e^2 + added^2) over e, less one.
double grown(const json& row) {
  return std::hypot(1.0, row.value("added_by_reading", 0.0) / row.value("standard_error", 1.0)) -
         1.0;
}

}  // namespace

std::string all_pixels_in_words(const json& told) {
  constexpr double kFar = 1.96;  // standard errors: an interval ends there
  if (!told.is_object()) return "";
  const json rows = told.value("parameters", json::array());
  const double pixels = told.value("pixels", 0.0), read = told.value("read_pixels", 0.0);
  const double share = told.value("share", 1.0), of_one = share * pixels / std::max(1.0, read);
  std::string out = fmt::format(
      "the fit has seen {:.0f} % of {:.3g} million pixels{}; intervals and pictures are of all of "
      "them (chi {:.3f})",
      100.0 * share, pixels / 1e6,
      of_one > 1.5 ? fmt::format(" by means over {:.0f}",
                                 std::exp2(2.0 * std::round(std::log2(of_one) / 2.0)))
                   : "",
      told.value("chi_fit", 0.0));
  const json* moved = most(rows, moved_of_error);
  const json* added = most(rows, grown);
  if (!moved || !added) return out;
  out += fmt::format(
      ". All pixels would move {} most, by {:.2g} standard errors; leaving some out adds {:.2g} % "
      "to a standard error at most ({})",
      moved->value("name", ""), moved_of_error(*moved), 100.0 * grown(*added),
      added->value("name", ""));
  if (moved_of_error(*moved) > kFar)
    out += ". That is beyond its interval: fit all pixels (--set fit.pixels=0)";
  return out;
}

}  // namespace hookeye
