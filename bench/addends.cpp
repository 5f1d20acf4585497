// Draws one addend of every kind from the law itself: bench_addends > docs/images/addends.svg
// Blue: energy; red: its slope, the stress; dots: control points. Each scaled to its own panel.
// Where energies are compared, the second is green and the mean of both dashed.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>

#include "simulation/additive.h"

namespace hookeye {
namespace {

constexpr double kWide = 220, kHigh = 150, kMargin = 34;

struct Panel {
  std::string title, axis;
  AdditiveModel model;
  double low, high;
};

Panel one(const std::string& title, const std::string& component, std::vector<double> at,
          std::vector<double> values, double low, double high) {
  Panel panel{title, component, {}, low, high};
  add_addend(
      panel.model, component, std::move(at), {},
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  return panel;
}

std::vector<Panel> panels() {
  std::vector<Panel> all = {
      one("quadratic: one control point", "E11", {0}, {1}, -0.4, 0.4),
      one("stiffening", "E11", {-0.3, 0, 0.15, 0.3}, {1, 1, 2, 5}, -0.4, 0.4),
      one("tension unlike compression", "E11", {-0.05, 0.05}, {0.3, 2}, -0.4, 0.4),
      one("shear: an even function", "E12", {0, 0.15, 0.3}, {0.5, 1, 3}, -0.4, 0.4),
      one("rubber that softens, then stiffens", "I1bar", {0, 0.6, 1.5}, {1, 0.5, 1.5}, 0, 1.8),
      one("volume: J - 1", "J", {-0.3, 0, 0.3}, {5, 2, 1}, -0.5, 0.5),
      one("sum of the stretches: trE", "trE", {-0.2, 0, 0.2}, {4, 2, 1}, -0.4, 0.4),
      one("fibres that pull and do not push", "fibre1", {-0.02, 0.02, 0.3}, {0, 1, 4}, -0.4, 0.4),
      one("a limit: wall from 0.2 over 0.05", "E11", {0}, {1}, -0.4, 0.4)};
  AdditiveModel& wall = all.back().model;
  add_addend(wall, "E11", {0.2, 0.25}, {}, Eigen::Vector2d(0, 30));
  wall.addends.back().name = "E11.wall";
  wall.addends.back().fixed = true;
  return all;
}

/// Two energies in one panel: along two axes, or at two ends of a body.
struct Comparison {
  std::string title, axis, first_name, second_name;
  AdditiveModel first, second;
  bool blended;  ///< whether their mean is an energy that the body has halfway
};

std::vector<Comparison> comparisons() {
  return {{"anisotropy: each axis its own", "E11, E22", "E11", "E22",
           one("", "E11", {-0.1, 0.1, 0.3}, {0.5, 2, 5}, 0, 0).model,
           one("", "E22", {-0.1, 0.1, 0.3}, {0.5, 1, 1.5}, 0, 0).model, false},
          {"blend: stiffer from foot to head", "E11", "head", "foot",
           one("", "E11", {0}, {3}, 0, 0).model, one("", "E11", {0}, {1}, 0, 0).model, true}};
}

/// Polyline of values over [low, high] in the panel at (x0, y0), between `least` and `most`.
std::string line(const std::vector<double>& values, double x0, double y0, double least, double most,
                 const char* colour) {
  std::string points;
  for (size_t i = 0; i < values.size(); ++i)
    points +=
        fmt::format("{:.1f},{:.1f} ",
                    x0 + kWide * static_cast<double>(i) / static_cast<double>(values.size() - 1),
                    y0 + kHigh * (1 - (values[i] - least) / (most - least)));
  return fmt::format("<polyline fill='none' stroke='{}' stroke-width='2' points='{}'/>\n", colour,
                     points);
}

std::string frame(const std::string& title, const std::string& axis, double x0, double y0) {
  return fmt::format(
      "<text x='{}' y='{}' font-weight='bold'>{}</text>"
      "<text x='{}' y='{}' text-anchor='end'>{}</text>\n"
      "<rect x='{}' y='{}' width='{}' height='{}' fill='none' stroke='#999'/>\n",
      x0, y0 - 6, title, x0 + kWide, y0 + kHigh + 14, axis, x0, y0, kWide, kHigh);
}

std::string draw(const Panel& panel, double x0, double y0) {
  constexpr int kPoints = 161;
  std::vector<double> energy, stress;
  const auto sum = [&](double e) {
    Eigen::Vector3d all = Eigen::Vector3d::Zero();
    for (size_t a = 0; a < panel.model.addends.size(); ++a)
      all += addend_curve(panel.model, static_cast<int>(a), e);
    return all;
  };
  for (int i = 0; i < kPoints; ++i) {
    const Eigen::Vector3d here = sum(panel.low + (panel.high - panel.low) * i / (kPoints - 1));
    energy.push_back(here[0]);
    stress.push_back(here[1]);
  }
  const double most = *std::max_element(energy.begin(), energy.end());
  double steep = 0;
  for (double s : stress) steep = std::max(steep, std::abs(s));
  const double least = panel.low < 0 ? -most : 0.0;
  std::string out = frame(panel.title, panel.axis, x0, y0);
  out += line(stress, x0, y0, panel.low < 0 ? -steep : 0, steep, "#d1495b");
  out += line(energy, x0, y0, least, most, "#2166ac");
  for (const Addend& a : panel.model.addends)
    for (double e : a.at)
      out += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='4' fill='#2166ac'/>\n",
                         x0 + kWide * (e - panel.low) / (panel.high - panel.low),
                         y0 + kHigh * (1 - (sum(e)[0] - least) / (most - least)));
  return out;
}

std::string draw(const Comparison& both, double x0, double y0) {
  constexpr int kPoints = 81;
  std::vector<double> first, second, mean;
  for (int i = 0; i < kPoints; ++i) {
    const double e = -0.4 + 0.8 * i / (kPoints - 1);
    first.push_back(addend_curve(both.first, 0, e)[0]);
    second.push_back(addend_curve(both.second, 0, e)[0]);
    mean.push_back(0.5 * (first.back() + second.back()));
  }
  const double most = *std::max_element(first.begin(), first.end());
  std::string out = frame(both.title, both.axis, x0, y0) +
                    line(second, x0, y0, 0, most, "#1b7837") +
                    line(first, x0, y0, 0, most, "#2166ac");
  if (both.blended)
    out += "<g stroke-dasharray='5 4'>" + line(mean, x0, y0, 0, most, "#777") + "</g>\n";
  return out + fmt::format(
                   "<text x='{}' y='{}' fill='#2166ac'>{}</text>"
                   "<text x='{}' y='{}' fill='#1b7837'>{}</text>\n",
                   x0 + 90, y0 + 20, both.first_name, x0 + 90, y0 + 36, both.second_name);
}

/// The barrier below a volume ratio, from the law's own energy of a body squeezed from all sides.
std::string draw_barrier(double x0, double y0) {
  constexpr double kBelow = 0.3, kLeast = 0.02, kMost = 0.5;
  constexpr int kPoints = 161;
  AdditiveModel model = one("", "J", {0}, {1e-9}, 0, 0).model;
  model.barrier_modulus = 1.0;
  model.barrier_below = kBelow;
  const auto law = additive(model);
  std::vector<double> energy, stress;
  for (int i = 0; i < kPoints; ++i) {
    const double J = kLeast + (kMost - kLeast) * i / (kPoints - 1);
    const Eigen::Matrix3d F = std::cbrt(J) * Eigen::Matrix3d::Identity();
    energy.push_back(law->psi(F));
    // d(psi)/dJ of F = J^(1/3) I: P : I / (3 J^(2/3))
    stress.push_back(law->P(F).trace() / (3.0 * std::cbrt(J * J)));
  }
  const double most = energy.front(), steep = -stress.front();
  return frame("barrier: below J = 0.3", "J", x0, y0) +
         line(stress, x0, y0, -steep, steep, "#d1495b") +
         line(energy, x0, y0, -most, most, "#2166ac");
}

/// The addend of two components as a map: blue below zero, red above.
std::string draw_pair(double x0, double y0) {
  AdditiveModel model;
  Eigen::VectorXd grid(4);
  grid << 0.2, 0.5, 1.0, 2.5;
  add_addend(model, "E11_E22", {-0.1, 0.3}, {-0.1, 0.3}, grid);
  std::string out = fmt::format(
      "<text x='{}' y='{}' font-weight='bold'>two components: zero on both axes</text>\n", x0,
      y0 - 6);
  constexpr int kCells = 30;
  double most = 0;
  const auto psi = [&](double a, double b) {
    return addend_energy_basis(model, 0, a, b).dot(grid);
  };
  for (double s : {-0.4, 0.4}) most = std::max({most, std::abs(psi(s, s)), std::abs(psi(s, -s))});
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j) {
      const double v = psi(-0.4 + 0.8 * (i + 0.5) / kCells, -0.4 + 0.8 * (j + 0.5) / kCells) / most;
      const int fade = static_cast<int>(255 * (1 - std::sqrt(std::abs(v))));
      out += fmt::format(
          "<rect x='{:.1f}' y='{:.1f}' width='{:.2f}' height='{:.2f}' fill='rgb({},{},{})'/>",
          x0 + kWide * i / kCells, y0 + kHigh * (kCells - 1 - j) / kCells, kWide / kCells + 0.3,
          kHigh / kCells + 0.3, v > 0 ? 255 : fade, fade, v > 0 ? fade : 255);
    }
  for (double a : {-0.1, 0.3})
    for (double b : {-0.1, 0.3})
      out += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='4' fill='black'/>\n",
                         x0 + kWide * (a + 0.4) / 0.8, y0 + kHigh * (0.4 - b) / 0.8);
  return out + fmt::format("<text x='{}' y='{}'>E11</text><text x='{}' y='{}'>E22</text>\n",
                           x0 + kWide - 28, y0 + kHigh + 14, x0 - 26, y0 + 12);
}

void draw_all() {
  const std::vector<Panel> all = panels();
  const std::vector<Comparison> compared = comparisons();
  std::vector<std::function<std::string(double, double)>> drawings;
  for (const Panel& panel : all)
    drawings.push_back([&panel](double x0, double y0) { return draw(panel, x0, y0); });
  drawings.push_back(draw_pair);
  drawings.push_back(draw_barrier);
  for (const Comparison& both : compared)
    drawings.push_back([&both](double x0, double y0) { return draw(both, x0, y0); });
  const auto rows = static_cast<double>((drawings.size() + 3) / 4);
  const double column = kWide + kMargin, row = kHigh + 2 * kMargin - 18;
  std::cout << fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {} {}' font-family='sans-serif' "
      "font-size='12'>\n<rect width='100%' height='100%' fill='white'/>\n",
      4 * column + kMargin, rows * row + 8);
  for (size_t i = 0; i < drawings.size(); ++i) {
    const double x0 = kMargin + column * static_cast<double>(i % 4);
    const double y0 = 24 + row * static_cast<double>(i / 4);
    std::cout << drawings[i](x0, y0);
  }
  std::cout << "</svg>\n";
}

}  // namespace
}  // namespace hookeye

int main() { hookeye::draw_all(); }
