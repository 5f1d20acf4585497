// One small capture told in other frames, units and orders: the same misfit, the same parameters,
// the same ranking, the same answer. Deviations are printed; bounds say where they come from.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <optional>
#include <thread>

#include "estimation/discover.h"
#include "estimation/synth.h"
#include "tests/invariance/transformed.h"
#include "tests/support/temporary_folder.h"

namespace hookeye::test {

namespace {

namespace fs = std::filesystem;

/// A leaning blob whose weight is not told, solved on the mesh that the capture tells, so that
/// nothing else is missing.
const char* const kRecipe = R"(hookeye_recipe: 1
seed: 5
body:
  shape: block
  size: [20, 16, 34]
  bumps: 0.08
  taper: 0.85
  facet: 7
  mesh: {edge: 8.5}
  density: 1.07e-9
  texture: {texel: 0.16, speckle: 1.8}
material: {law: neo-hookean, true: {mu: 0.02, kappa_over_mu: 10}, told: {mu: 0.02}, fit: [mu]}
cameras: {count: 2, size: [120, 150], distance: 6, focal: 540}
examples:
  rest: {}
  pull: {force: [0, 0, 0.3]}
  side: {force: [0.012, 0.006, 0]}
  poke: {use: validate, force: [-0.008, 0.01, 0.12]}
hidden:
  - {effect: gravity, values: {gravity.x: 2500, gravity.y: 1500, gravity.z: -9300}}
truth: {edge_factor: 1, rays_per_axis: 4, visibility_rays: 256}
)";

/// The capture told otherwise.
struct Telling {
  std::string name;
  Frame frame = {};
  Order order = {};
  int threads = 0;  ///< 0: all
};

const std::vector<Telling>& tellings() {
  static const std::vector<Telling> all = {
      {.name = "as it was"},
      {.name = "one thread", .threads = 1},
      {.name = "cameras in another order", .order = {.cameras = 2}},
      {.name = "examples in another order", .order = {.examples = 3}},
      {.name = "regions in another order", .order = {.regions = 2}},
      {.name = "nodes in another order", .order = {.nodes = 1}},
      {.name = "vertices in another order", .order = {.vertices = 1}},
      {.name = "in metres", .frame = in_metres()},
      {.name = "in micrometres", .frame = in_micrometres()},
      {.name = "moved by 300 mm", .frame = moved({-120, 200, 180})},
      {.name = "turned", .frame = turned(1)},
      {.name = "turned otherwise", .frame = turned(2)},
  };
  return all;
}

/// The first telling: with a mesh of its own, regions as lists of faces.
const fs::path& first_telling() {
  static const TemporaryFolder folder;
  static const fs::path path = [] {
    std::get<Synthesis>(synthesize(parse_recipe(kRecipe, "recipe.yaml"), folder / "synthesised"));
    keep_own_mesh(folder / "synthesised");
    write_transformed(folder / "synthesised", folder / "first", {});
    return folder / "first";
  }();
  return path;
}

class Retold {
 public:
  explicit Retold(const Telling& telling)
      : limit_(tbb::global_control::max_allowed_parallelism,
               telling.threads ? telling.threads : std::thread::hardware_concurrency()) {
    write_transformed(first_telling(), folder_ / "capture", telling.frame, telling.order);
    scene_ = load_scene(read_capture(folder_ / "capture"));
    workspace_.emplace(scene_);
  }
  Workspace& workspace() { return *workspace_; }
  ModelForm form() const { return base_form(scene_); }

 private:
  TemporaryFolder folder_;
  tbb::global_control limit_;
  std::shared_ptr<const Scene> scene_;
  std::optional<Workspace> workspace_;
};

/// The same values told in the frame: moduli, accelerations and lengths by their units, x y z
/// together.
VectorXd retold(const std::vector<Parameter>& parameters, const VectorXd& values,
                const Frame& frame) {
  const auto ends = [](const std::string& name, const std::string& with) {
    return name.size() >= with.size() &&
           name.compare(name.size() - with.size(), with.size(), with) == 0;
  };
  VectorXd out = values;
  for (size_t i = 0; i < parameters.size(); ++i) {
    const std::string& unit = parameters[i].unit;
    if (unit == "MPa") out[i] *= frame.stress();
    if (unit == "mm/s^2" || unit == "mm") out[i] *= frame.length;
    if (i >= 2 && ends(parameters[i].name, "z") && ends(parameters[i - 2].name, "x"))
      out.segment<3>(i - 2) = frame.R * Vector3d(out.segment<3>(i - 2));
  }
  return out;
}

Fitted fitted_from(Retold& retold, const VectorXd& start, bool moving) {
  const ModelForm form = retold.form();
  auto result =
      moving ? fit(retold.workspace(), form, start) : assess(retold.workspace(), form, start);
  if (const auto* failure = std::get_if<NumericalFailure>(&result))
    throw std::runtime_error(failure->example + ": " + failure->reason);
  return std::get<Fitted>(std::move(result));
}

const Fitted& first_fit() {
  static Retold told({});
  static const Fitted fitted = fitted_from(told, told.form().initial(), true);
  return fitted;
}

double relative(double a, double b) { return std::abs(a - b) / std::max(std::abs(b), 1e-300); }

/// The same values: the same pictures, but for rays that meet another triangle.
TEST(Invariance, TheMisfitOfTheSameValues) {
  const Fitted& first = first_fit();
  for (const Telling& telling : tellings()) {
    SCOPED_TRACE(telling.name);
    Retold told(telling);
    const Fitted same =
        fitted_from(told, retold(first.form.parameters(), first.p, telling.frame), false);
    const double chi = relative(same.evaluation.chi(), first.evaluation.chi());
    const double held_out = relative(same.evaluation.chi(true), first.evaluation.chi(true));
    const double width =
        relative((same.high - same.low)[0] / telling.frame.stress(), (first.high - first.low)[0]);
    fmt::print("{:28} chi {:.9f} off by {:.1e}, held out {:.1e}, interval {:.1e}\n", telling.name,
               same.evaluation.chi(), chi, held_out, width);
    EXPECT_LT(chi, 1e-6);
    EXPECT_LT(held_out, 1e-6);
    EXPECT_LT(width, 1e-3);
  }
}

TEST(Invariance, TheFit) {
  const Fitted& first = first_fit();
  for (const Telling& telling : tellings()) {
    SCOPED_TRACE(telling.name);
    Retold told(telling);
    const Fitted fitted = fitted_from(told, told.form().initial(), true);
    const double chi = relative(fitted.evaluation.chi(), first.evaluation.chi());
    const VectorXd expected = retold(first.form.parameters(), first.p, telling.frame);
    const double off =
        ((fitted.p - expected).array() / (fitted.high - fitted.low).array()).abs().maxCoeff();
    fmt::print("{:28} chi off by {:.1e}, values by {:.1e} of their intervals\n", telling.name, chi,
               off);
    EXPECT_LT(chi, 1e-5);
    EXPECT_LT(off, 0.02);
  }
}

Diagnosis diagnosed(Retold& told, const Fitted& fitted) {
  auto result = diagnose(told.workspace(), fitted);
  if (const auto* failure = std::get_if<NumericalFailure>(&result))
    throw std::runtime_error(failure->example + ": " + failure->reason);
  return std::get<Diagnosis>(std::move(result));
}

const EffectScore* score_of(const Diagnosis& diagnosis, const std::string& effect) {
  for (const EffectScore& score : diagnosis.effects)
    if (score.effect == effect && score.testable) return &score;
  return nullptr;
}

/// Evidence of every effect at the same values.
TEST(Invariance, TheDiagnosis) {
  Retold first_told({});
  const Fitted& base = first_fit();
  const Fitted first_fitted = fitted_from(first_told, base.p, false);
  const Diagnosis first = diagnosed(first_told, first_fitted);
  for (const Telling& telling : tellings()) {
    SCOPED_TRACE(telling.name);
    Retold told(telling);
    const Fitted fitted =
        fitted_from(told, retold(base.form.parameters(), base.p, telling.frame), false);
    const Diagnosis now = diagnosed(told, fitted);
    EXPECT_EQ(now.effects.front().effect, "gravity");
    EXPECT_EQ(leaders(now), leaders(first));
    std::string off;
    for (const EffectScore& score : first.effects) {
      if (!score.testable) continue;
      const EffectScore* same = score_of(now, score.effect);
      ASSERT_TRUE(same) << score.effect;
      off += fmt::format(" {} {:.2f}{:+.4f}", score.effect, score.evidence,
                         same->evidence - score.evidence);
      if (same->best->variant() != score.best->variant() && telling.frame.R.isIdentity())
        off += fmt::format(" [{}: {}]", score.best->variant(), same->best->variant());
    }
    fmt::print("{}: gate {:.4f} {:+.4f}; floor {:.6f} {:+.1e}\n  {}\n", telling.name, first.gate,
               now.gate - first.gate, first.floor.chi, now.floor.chi - first.floor.chi, off);
  }
}

}  // namespace

}  // namespace hookeye::test
