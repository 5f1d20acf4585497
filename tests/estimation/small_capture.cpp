#include "tests/estimation/small_capture.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "capture_io/camera_covariance.h"
#include "estimation/effects/catalogue.h"
#include "estimation/synth/synth.h"

namespace hookeye::test {

namespace {

std::string recipe(const SmallCapture& capture) {
  return "hookeye_recipe: 1\nseed: " + std::to_string(capture.seed) + R"(
title: small block
body:
  shape: block
  size: [20, 16, 34]
  bumps: 0.05
  facet: 7
  mesh: {edge: 8}
  density: 1.07e-9
  texture: {texel: 0.12, speckle: 1.4}
material:
  law: neo-hookean
  true: {mu: 0.02, kappa_over_mu: 10}
  told: {mu: )" +
         capture.told + R"(}
  fit: [mu]
cameras: {count: 2, size: [200, 260], distance: 6, focal: 950}
examples:
  rest: {}
  pull: {force: [0, 0, 0.3]}
  side: {force: [0.012, 0.006, 0]}
)" + capture.loads +
         "  poke: {use: validate, force: [-0.008, 0.01, 0.12]}\n" + capture.hidden +
         "truth: {edge_factor: " + capture.truth_mesh +
         (capture.same_renderer ? ", rays_per_axis: 3, visibility_rays: 64}\n"
                                : ", rays_per_axis: 4, visibility_rays: 256}\n");
}

/// How well with_known_cameras() knows a number, and what camera_pose calls it.
struct Known {
  const char* name;
  double deviation;
  const char* pose;
  double sign;
};
constexpr Known kKnown[] = {
    {"rotation_x", 0.0005, "rx", 1.0},
    {"rotation_y", 0.0005, "ry", -1.0},
    {"rotation_z", 0.0005, "rz", 1.0},
    {"shift_x", 0.1, "tx", 1.0},
    {"shift_y", 0.1, "ty", -1.0},
    {"shift_z", 0.4, "tz", 1.0},
    {"fx", 0.95, "", 0.0},
    {"fy", 0.95, "", 0.0},
};

}  // namespace

SmallScene::SmallScene(const SmallCapture& capture) {
  const auto made = synthesize(
      parse_recipe(capture.recipe.empty() ? recipe(capture) : capture.recipe, "recipe.yaml"),
      folder_ / "capture");
  scene = load_scene(read_capture(made->capture));
}

std::string knocked(double deviations) {
  std::string values;
  for (const Known& one : kKnown)
    if (*one.pose)
      values += fmt::format("{}camera_pose.cam1.{}: {:g}", values.empty() ? "" : ", ", one.pose,
                            one.sign * deviations * one.deviation);
  return "hidden: [{effect: camera_pose, variant: \"cam1 from the start\", values: {" + values +
         "}}]\n";
}

std::shared_ptr<const Scene> with_known_cameras(const Scene& scene) {
  auto out = std::make_shared<Scene>(scene);
  auto known = std::make_shared<CameraCovariance>();
  std::vector<double> variances;
  for (const Camera& camera : scene.capture.cameras)
    for (const Known& one : kKnown) {
      known->numbers.push_back({camera.name, one.name});
      variances.push_back(one.deviation * one.deviation);
    }
  known->values =
      Eigen::Map<VectorXd>(variances.data(), static_cast<Eigen::Index>(variances.size()))
          .asDiagonal();
  out->capture.camera_covariance = known;
  measure_calibration(out->capture);
  return out;
}

Fitted base_fit(Workspace& workspace) {
  const ModelForm form = base_form(workspace.scene().shared_from_this());
  return fit(workspace, form, form.initial()).value();
}

Step base_step(Workspace& workspace) {
  Step step;
  step.name = "base";
  step.fitted = base_fit(workspace);
  step.diagnosis = diagnose(workspace, step.fitted).value();
  return step;
}

DiagnosisOptions of_alone(const std::vector<std::string>& effects) {
  DiagnosisOptions options;
  for (const auto& effect : catalogue())
    if (std::find(effects.begin(), effects.end(), effect->name()) == effects.end())
      options.without.push_back(effect->name());
  return options;
}

Discovery discover(const SmallScene& small, const DiscoverOptions& options) {
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  auto found = hookeye::discover(workspace, form, form.initial(), options);
  if (!found) throw std::runtime_error(found.error().example + ": " + found.error().reason);
  return *std::move(found);
}

double value_of(const Fitted& fitted, const std::string& name) {
  const auto parameters = fitted.form.parameters();
  for (size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].name == name) return fitted.p[static_cast<Eigen::Index>(i)];
  throw std::logic_error("no parameter " + name);
}

}  // namespace hookeye::test
