#include "batch/strip_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runs/text.h"

namespace hookeye {
namespace {

constexpr double kHighest = 420.0, kRow = 9.0;  // [px]
constexpr double kTop = 4.0, kAxis = 22.0;      // [px] above the rows, and below for the numbers

/// Values between `low` and `high`, as shares of the width.
struct StripScale {
  double low = 0.0, high = 1.0;
  /// [percent of the width]
  double at(double value) const {
    constexpr double kMargin = 3.0;
    const double share = std::clamp((value - low) / (high - low), -0.02, 1.02);
    return kMargin + (100.0 - 2.0 * kMargin) * share;
  }
};

StripScale scale_of(const std::vector<StripPoint>& points) {
  std::vector<double> widths;
  StripScale out{points.front().value, points.front().value};
  for (const StripPoint& one : points) {
    out.low = std::min(out.low, one.value);
    out.high = std::max(out.high, one.value);
    widths.push_back(one.high - one.low);
  }
  const double least = 1e-6 * std::max(std::abs(out.low), std::abs(out.high));
  const double pad =
      std::max({0.06 * (out.high - out.low), 0.7 * median_of(widths), least, 1e-300});
  return {out.low - pad, out.high + pad};
}

/// Round numbers, three to six of them.
std::vector<double> ticks_of(const StripScale& scale) {
  const double rough = (scale.high - scale.low) / 4.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = power;
  for (const double factor : {1.0, 2.0, 5.0, 10.0})
    if (step = factor * power; step >= rough) break;
  std::vector<double> out;
  for (double k = std::ceil(scale.low / step); k * step <= scale.high; k += 1.0)
    out.push_back(k * step);
  return out;
}

std::string axis(const StripScale& scale, double height) {
  std::string out;
  for (const double tick : ticks_of(scale)) {
    const double x = scale.at(tick);
    out += fmt::format(
        "<line class=\"grid\" x1=\"{0:.2f}%\" x2=\"{0:.2f}%\" y1=\"0\" y2=\"{1:.1f}\"/>"
        "<text x=\"{0:.2f}%\" y=\"{2:.1f}\" text-anchor=\"middle\">{3:.6g}</text>",
        x, height - kAxis + 4.0, height - 5.0, std::abs(tick) < 1e-12 * scale.high ? 0.0 : tick);
  }
  return out;
}

std::string words_of(const StripPoint& one, const std::string& unit) {
  std::string out = fmt::format("{}: {:.5g}", one.label, one.value);
  if (one.high > one.low) out += fmt::format(" ({:.5g} .. {:.5g})", one.low, one.high);
  if (!unit.empty()) out += " " + unit;
  return out + (one.outlier ? ", far from the others" : "") +
         (one.explained ? "" : ", not explained");
}

std::string mark(const StripPoint& one, const StripScale& scale, double y, double row,
                 const std::string& unit) {
  const double x = scale.at(one.value);
  std::string out = one.link.empty() ? "<g>" : fmt::format("<a href=\"{}\">", html_text(one.link));
  out += fmt::format(
      "<title>{}</title><rect class=\"hit\" x=\"0\" width=\"100%\" y=\"{:.2f}\" "
      "height=\"{:.2f}\"/>",
      html_text(words_of(one, unit)), y - row / 2.0, row);
  const char* kind = one.outlier ? "far" : one.explained ? "" : "open";
  if (one.high > one.low)
    out += fmt::format(
        "<line class=\"whisker {}\" x1=\"{:.2f}%\" x2=\"{:.2f}%\" y1=\"{:.2f}\" y2=\"{:.2f}\"/>",
        kind, scale.at(one.low), scale.at(one.high), y, y);
  out += fmt::format("<circle class=\"dot {}\" cx=\"{:.2f}%\" cy=\"{:.2f}\" r=\"{:.1f}\"/>", kind,
                     x, y, one.outlier ? 4.0 : std::clamp(0.45 * row, 1.8, 3.6));
  if (one.outlier) {
    const bool left = x > 55.0;
    out += fmt::format(
        "<text class=\"far\" x=\"{:.2f}%\" dx=\"{}\" y=\"{:.2f}\" text-anchor=\"{}\">{}</text>", x,
        left ? -8 : 8, y + 4.0, left ? "end" : "start", html_text(one.label));
  }
  return out + (one.link.empty() ? "</g>" : "</a>");
}

}  // namespace

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

void mark_outliers(std::vector<StripPoint>& points) {
  constexpr size_t kFewest = 5;
  constexpr double kFar = 3.5, kSigma = 1.4826, kHalfWidth = 1.96;
  for (StripPoint& one : points) one.outlier = false;
  if (points.size() < kFewest) return;
  std::vector<double> values, deviations;
  for (const StripPoint& one : points) values.push_back(one.value);
  const double middle = median_of(values);
  for (const double value : values) deviations.push_back(std::abs(value - middle));
  const double spread = kSigma * median_of(deviations);
  for (StripPoint& one : points) {
    const double own = (one.high - one.low) / 2.0 / kHalfWidth;
    one.outlier = std::abs(one.value - middle) > kFar * std::max(spread, own) &&
                  std::abs(one.value - middle) > 1e-9 * std::abs(middle);
  }
}

std::string strip_plot(std::vector<StripPoint> points, const std::string& unit) {
  if (points.empty()) return {};
  std::sort(points.begin(), points.end(),
            [](const StripPoint& a, const StripPoint& b) { return a.value < b.value; });
  const double count = static_cast<double>(points.size());
  const double row = std::min(kRow, kHighest / count), height = kTop + row * count + kAxis;
  const StripScale scale = scale_of(points);
  std::vector<double> values;
  for (const StripPoint& one : points) values.push_back(one.value);
  const double middle = median_of(values);
  std::string out = fmt::format("<svg class=\"strip\" role=\"img\" height=\"{:.0f}\">", height);
  out += axis(scale, height);
  out += fmt::format(
      "<line class=\"median\" x1=\"{0:.2f}%\" x2=\"{0:.2f}%\" y1=\"0\" y2=\"{1:.1f}\"/>",
      scale.at(middle), height - kAxis + 4.0);
  for (size_t i = 0; i < points.size(); ++i)
    out += mark(points[i], scale, kTop + row * (static_cast<double>(i) + 0.5), row, unit);
  return out + "</svg>";
}

}  // namespace hookeye
