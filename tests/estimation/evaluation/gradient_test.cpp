// The gradient of the whole misfit by everything a base model can leave open, against differences
// of the misfit itself: equilibria, pictures, contours and measured values together.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <regex>

#include "estimation/effects/catalogue.h"
#include "estimation/evaluation/columns.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/solved_sensitivity.h"
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
    if (!result) throw std::runtime_error(result.error().reason);
    return *std::move(result);
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
    return workspace.evaluate(form, at, options).value().examples.at(0).measured;
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

/// A force sensor's zero moves what it shows and nothing else.
TEST(Gradient, OfAForceZeroIsExact) {
  const ModelForm& base = test::base();
  const auto candidates = find_effect("force_zero")->candidates(test::base_model(), nullptr);
  ASSERT_FALSE(candidates.empty());
  const ModelForm form = test::extended(base, candidates.front());
  const VectorXd p = test::with_values(form, test::some_values(*candidates.front()));
  const int twist = base.scene->example_index("twist");
  const auto shown = [&](const VectorXd& at) {
    return test::evaluated(form, at, {}).find(twist)->measured.at(0);
  };
  const Eigen::Matrix3Xd J = shown(p).J;
  for (Eigen::Index i = base.size(); i < p.size(); ++i)
    test::expect_derivative(
        [&](double h) -> VectorXd { return shown(p + h * VectorXd::Unit(p.size(), i)).r; },
        J.col(i), form.parameters()[i].typical, 1e-6, form.parameters()[i].name);
}

/// The level behind the body, on top of the told one.
class LevelBehind final : public Ingredient {
 public:
  std::string name() const override { return "level behind"; }
  std::vector<Parameter> parameters() const override {
    return {{"level", "", "", 0.0, -1.0, 1.0, 0.1, false}};
  }
  Touches touches() const override { return {.photos = true}; }
  void apply(const VectorXd& values, Model& model) const override {
    for (auto& example : model.examples)
      for (auto& photo : example.photos) photo.background += values[0];
  }
};

/// Photos that are out of focus.
class Blurred final : public Ingredient {
 public:
  std::string name() const override { return "blurred"; }
  std::vector<Parameter> parameters() const override { return {}; }
  Touches touches() const override { return {.photos = true}; }
  void apply(const VectorXd&, Model& model) const override {
    for (auto& example : model.examples)
      for (auto& photo : example.photos) photo.blur_variance += 0.4;
  }
};

/// The block with photos of which only what the body covers counts: next to it the model has no
/// slope.
std::shared_ptr<const Scene> covered_scene() {
  auto scene = std::make_shared<Scene>(*test::block_scene());
  EvaluationOptions options;
  options.derivatives = false;
  options.residuals = options.held_out = true;
  const auto seen =
      test::workspace().evaluate(test::base(), test::base().initial(), options).value();
  for (const auto& example : seen.examples)
    for (const auto& photo : example.photos) {
      auto& valid = scene->photos[example.example][photo.photo].valid.own();
      valid.assign(photo.model.pixels(), 0);
      // nor at the picture's border, where blur is no convolution
      constexpr int kBorder = 6;
      for (int y = kBorder; y < photo.model.height - kBorder; ++y)
        for (int x = kBorder; x < photo.model.width - kBorder; ++x)
          valid[static_cast<size_t>(y) * photo.model.width + x] = photo.model.at(x, y) > 0.01f;
    }
  return scene;
}

/// Effects of the sensor and the light, the first and the last of each. Not those that turn the
/// sun: shadows move with it.
std::vector<std::shared_ptr<const Ingredient>> of_light_and_sensor() {
  std::vector<std::shared_ptr<const Ingredient>> out = {std::make_shared<LevelBehind>()};
  for (const char* name : {"exposure", "light_direction", "specular", "defocus"}) {
    auto all = find_effect(name)->candidates(test::base_model(), nullptr);
    std::erase_if(all, [](const auto& one) { return one->variant().starts_with("sun "); });
    out.push_back(all.front());
    if (all.size() > 1) out.push_back(all.back());
  }
  return out;
}

/// The level behind the body is the square of the value.
class SquareBehind final : public Ingredient {
 public:
  std::string name() const override { return "square behind"; }
  std::vector<Parameter> parameters() const override {
    return {{"root", "", "", 0.3, 0.2, 0.7, 0.1, false}};
  }
  Touches touches() const override { return {.photos = true}; }
  void apply(const VectorXd& values, Model& model) const override {
    for (auto& example : model.examples)
      for (auto& photo : example.photos) photo.background = values[0] * values[0];
  }
};

/// Differences stay within a parameter's bounds and are of second order at both of them.
TEST(Columns, AreExactForSquaresAtBothBounds) {
  const ModelForm form = test::extended(test::base(), std::make_shared<SquareBehind>());
  Equilibrium state;
  state.q = test::deformed_state(*form.scene);
  for (const double value : {0.2, 0.41, 0.7}) {
    const VectorXd p = test::with_values(form, VectorXd::Constant(1, value));
    const ExampleColumns columns = ColumnSet(form, p, {}).of_example(form.realise(p), 1, state);
    EXPECT_NEAR(columns.dphoto.at(0)(kBackground, form.size() - 1), 2.0 * value, 1e-9) << value;
  }
}

/// Silhouettes are coverage alone: whatever changes light or sensor has no slope in them.
TEST(Gradient, OfSilhouettesKnowsNoLight) {
  auto scene = std::make_shared<Scene>(*test::block_scene());
  for (auto& example : scene->capture.examples)
    for (auto& photo : example.photos) photo.kind = PhotoSpec::Kind::silhouette;
  Workspace workspace(scene);
  for (const auto& ingredient : of_light_and_sensor()) {
    if (ingredient->name() == "defocus") continue;
    const ModelForm form = test::extended(base_form(scene), ingredient);
    const VectorXd p = test::with_values(form, test::some_values(*ingredient));
    const auto seen = workspace.evaluate(form, p, {}).value();
    const auto own = static_cast<Eigen::Index>(ingredient->parameters().size());
    double of_material = 0.0;
    for (const auto& example : seen.examples)
      for (const auto& photo : example.photos) {
        EXPECT_EQ(photo.sums.Jtr.tail(own).norm(), 0.0) << ingredient->name();
        EXPECT_EQ(photo.sums.JtJ.rightCols(own).norm(), 0.0) << ingredient->name();
        of_material += photo.sums.JtJ(0, 0);
      }
    EXPECT_GT(of_material, 0.0);
  }
}

/// A body without a texture: as it bends its shading changes, far from rims that move.
TEST(Gradient, OfShadingAlone) {
  const test::SmallScene small({.same_renderer = true});
  auto scene = std::make_shared<Scene>(*small.scene);
  scene->capture.body.texture = BodySpec::Texture::uniform;
  scene->capture.light.ambient = 0.0;  // the sky's share jumps from facet to facet
  const int bend = scene->example_index("side");
  const ModelForm form = base_form(scene);
  const VectorXd p = form.initial();
  const auto look = [&](Workspace& workspace, const VectorXd& at, bool derivatives) {
    EvaluationOptions options;
    options.derivatives = derivatives;
    options.residuals = true;
    options.only = {bend};
    options.tolerance = 1e-10;
    return workspace.evaluate(form, at, options).value();
  };
  Workspace bare(scene);
  const Evaluation whole = look(bare, p, false);
  for (const auto& photo : whole.examples.at(0).photos) {
    const Image& I = photo.model;
    const float brightest = *std::max_element(I.values.begin(), I.values.end());
    auto& valid = scene->photos[bend][photo.photo].valid.own();
    valid.assign(I.pixels(), 0);
    for (int y = 3; y < I.height - 3; ++y)
      for (int x = 3; x < I.width - 3; ++x) {
        bool inside = true;
        for (int dy = -3; dy <= 3; ++dy)
          for (int dx = -3; dx <= 3; ++dx)
            inside = inside && I.at(x + dx, y + dy) > 0.5f * brightest;
        valid[static_cast<size_t>(y) * I.width + x] = inside;
      }
  }
  Workspace workspace(scene);
  const NormalEquations sums = normal_equations(look(workspace, p, true));
  ASSERT_EQ(form.parameters()[0].name, "mu");
  test::expect_derivative(
      [&](double h) {
        return VectorXd::Constant(
            1, normal_equations(look(workspace, p + h * VectorXd::Unit(p.size(), 0), false)).r2);
      },
      VectorXd::Constant(1, 2.0 * sums.Jtr[0]), 0.01 * p[0], 0.01, "mu");
}

/// Light and sensor move no rim: pixel by pixel their slopes are those of the picture. At full size
/// and at half, by squares and by Huber's loss, in focus and out of it.
TEST(Gradient, OfLightAndSensorIsExact) {
  const auto scene = covered_scene();
  Workspace workspace(scene);
  const auto check = [&](const ModelForm& base, const EvaluationOptions& how,
                         const std::string& what) {
    int checked = 0;
    for (const auto& ingredient : of_light_and_sensor()) {
      const ModelForm form = test::extended(base, ingredient);
      const bool blur =
          ingredient->name() == "defocus" && base.ingredients.back()->name() != "blurred";
      const VectorXd p = test::with_values(
          form, blur ? test::null_values(*ingredient) : test::some_values(*ingredient));
      const auto look = [&](const VectorXd& at, bool derivatives) {
        EvaluationOptions options = how;
        options.derivatives = derivatives;
        return workspace.evaluate(form, at, options).value();
      };
      const auto misfit = [&](const VectorXd& at) { return normal_equations(look(at, false)).r2; };
      const NormalEquations sums = normal_equations(look(p, true));
      const auto parameters = form.parameters();
      for (Eigen::Index i = base.size(); i < p.size(); ++i) {
        const auto at = [&](double t) { return misfit(p + t * VectorXd::Unit(p.size(), i)); };
        const auto moved = [&](double t) {
          // there is no blur below none: the parabola through three pictures goes on
          const double sum = blur && t < 0.0 ? 3 * at(0.0) - 3 * at(-t) + at(-2 * t) : at(t);
          return VectorXd::Constant(1, sum);
        };
        test::expect_derivative(moved, VectorXd::Constant(1, 2.0 * sums.Jtr[i]),
                                0.01 * parameters[i].typical, 1e-3, parameters[i].name + what);
        ++checked;
      }
    }
    EXPECT_GE(checked, 8) << what;
  };
  EvaluationOptions half, huber;
  half.level = 1;
  huber.huber = 5.0;
  const ModelForm base = base_form(scene);
  check(base, {}, "");
  check(base, half, ", half size");
  check(base, huber, ", Huber");
  check(test::extended(base, std::make_shared<Blurred>()), {}, ", blurred");
}

}  // namespace
}  // namespace hookeye
