// The gradient of the whole misfit by everything a base model can leave open, against differences
// of the misfit itself: equilibria, pictures, contours and measured values together.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <regex>

#include "estimation/normal_equations.h"
#include "support/derivative.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

std::string replaced(const std::string& text, const std::string& what, const std::string& by) {
  const std::string out = std::regex_replace(text, std::regex(what), by);
  if (out == text) throw std::logic_error("there is no " + what);
  return out;
}

/// The small capture with all that can be left open left open: material, placement, light,
/// background, the motion of the grip; and with every kind of measurement.
std::shared_ptr<const Scene> open_scene(const test::SmallScene& small) {
  const std::filesystem::path file = small.scene->capture.folder / "open.yaml";
  std::ifstream told(small.scene->capture.file);
  std::string text{std::istreambuf_iterator<char>(told), {}};
  text = replaced(text, "kappa_over_mu: [^,]*,", "kappa: 0.21,");
  text = replaced(text, "fit: \\[mu\\]", "fit: [mu, kappa]");
  text = replaced(text, "  density:", "  placement: fit\n  density:");
  text = replaced(text, "light:\n[^\n]*\n[^\n]*\n", "");
  text = replaced(text, "background: black", "background: fit");
  text = replaced(text, "rigid: \\{move: \\[0, 0, 0\\].*\\}\\}", "rigid: fit");
  text =
      replaced(text, "    measured:\n",
               "    measured:\n    - {position_of: [10, 0, 17], value: [9, 1, 17], sigma: 0.1}\n");
  std::ofstream(file) << text;
  return load_scene(read_capture(file));
}

TEST(Gradient, IsThatOfTheMisfitByEverythingLeftOpen) {
  const test::SmallScene small({.same_renderer = true});
  const auto scene = open_scene(small);
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto parameters = form.parameters();
  // From the truth, that every slope may be there and no rim be far off: some hundredths, or a
  // fraction of what matters.
  const std::map<std::string, double> truth = {
      {"mu", 0.02},      {"kappa", 0.2},   {"twist.grip.rz", 20 * M_PI / 180},
      {"ambient", 0.35}, {"sun.x", 0.304}, {"sun.y", -0.243},
      {"sun.z", 0.456}};
  VectorXd p = form.initial();
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    const Parameter& one = parameters[i];
    if (const auto told = truth.find(one.name); told != truth.end()) p[i] = told->second;
    if (one.name.starts_with("background")) continue;
    p[i] += (i % 2 ? -1.0 : 1.0) * (one.positive ? 0.04 * p[i] : 0.2 * one.typical);
  }
  const auto look = [&](const VectorXd& at, bool derivatives) {
    EvaluationOptions options;
    options.derivatives = derivatives;
    options.tolerance = 1e-11;
    auto result = workspace.evaluate(form, at, options);
    if (auto* failure = std::get_if<NumericalFailure>(&result))
      throw std::runtime_error(failure->reason);
    return std::get<Evaluation>(std::move(result));
  };
  const auto misfit = [&](const VectorXd& at) {
    double sum = 0.0;
    for (const auto& example : look(at, false).examples) {
      for (const auto& photo : example.photos) sum += photo.r2;
      for (const auto& measured : example.measured) sum += measured.r.squaredNorm();
    }
    return sum;
  };
  const NormalEquations sums = normal_equations(look(p, true));
  int checked = 0;
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    const Parameter& one = parameters[i];
    // A level that is off by more than noise lets all that is behind the body count as body: the
    // misfit has steps there (OwnPhotos fits it).
    if (one.name.starts_with("background")) continue;
    // What moves the rim is looked at over some tenths of a pixel: it passes the rays of the
    // pattern one by one.
    const double h = one.positive ? 0.05 * p[i] : 0.3 * one.typical;
    test::expect_derivative(
        [&](double t) {
          return VectorXd::Constant(1, misfit(p + t * VectorXd::Unit(p.size(), i)));
        },
        // the sky's share of each vertex is held constant, and rims are passed ray by ray
        VectorXd::Constant(1, 2.0 * sums.Jtr[i]), h, 0.05, one.name);
    ++checked;
  }
  EXPECT_EQ(checked, 2 + 6 + 4 + 6);
}

/// Forces, moments and positions have no rims: their derivatives are exact.
TEST(Gradient, OfMeasuredValuesIsExact) {
  const test::SmallScene small({.same_renderer = true});
  const auto scene = open_scene(small);
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto parameters = form.parameters();
  VectorXd p = form.initial();
  for (Eigen::Index i = 0; i < p.size(); ++i)
    p[i] += (i % 2 ? -0.2 : 0.2) * (parameters[i].positive ? 0.2 * p[i] : parameters[i].typical);
  const int twist = scene->example_index("twist");
  const auto measured = [&](const VectorXd& at, bool derivatives) {
    EvaluationOptions options;
    options.derivatives = derivatives;
    options.only = {twist};
    options.tolerance = 1e-10;
    options.level = 2;  // small pictures: they are not looked at
    return std::get<Evaluation>(workspace.evaluate(form, at, options)).examples.at(0).measured;
  };
  const auto now = measured(p, true);
  ASSERT_EQ(now.size(), 3u);
  for (size_t k = 0; k < now.size(); ++k) {
    int moved = 0;
    for (Eigen::Index i = 0; i < p.size(); ++i) {
      if (now[k].J.col(i).isZero(0.0)) continue;
      ++moved;
      const double typical = parameters[i].positive ? p[i] : parameters[i].typical;
      test::expect_derivative(
          [&](double t) -> VectorXd {
            return measured(p + t * VectorXd::Unit(p.size(), i), false)[k].r;
          },
          now[k].J.col(i), 0.01 * typical, 1e-4, parameters[i].name);
    }
    // material and grip in all three, the set-up's place in positions
    EXPECT_GE(moved, k == 0 ? 2 + 6 + 6 : 2 + 6) << k;
  }
}

}  // namespace
}  // namespace hookeye
