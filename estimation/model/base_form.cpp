// The base model of a capture: what the user believes, and what the capture leaves open.
#include <fmt/format.h>

#include <Eigen/Geometry>

#include "estimation/model/additive_material.h"
#include "estimation/model/base_ingredients.h"
#include "estimation/model/camera_calibration.h"
#include "estimation/model/model.h"
#include "estimation/model/travels.h"

namespace hookeye {

namespace {

VectorXd elements_of_group(const TetMesh& mesh, const MaterialSpec& spec) {
  const auto group = mesh.volume_groups.find(spec.region);
  if (group == mesh.volume_groups.end()) {
    std::vector<std::string> known;
    for (const auto& [name, elements] : mesh.volume_groups) known.push_back(name);
    const std::string near = nearest_name(spec.region, known);
    throw InputError(spec.place, "the body has no region '" + spec.region + "'",
                     near.empty() ? "name a physical volume group of the volume file"
                                  : "did you mean '" + near + "'?");
  }
  VectorXd weight = VectorXd::Zero(mesh.size());
  for (int e : group->second) weight[e] = 1.0;
  return weight;
}

/// Weight of a law, one an element; empty: 1 everywhere. A blend is taken at the middle of the
/// element's corners.
VectorXd element_weights(const TetMesh& mesh, const MaterialSpec& spec) {
  if (!spec.blend) return spec.region.empty() ? VectorXd() : elements_of_group(mesh, spec);
  VectorXd weight(mesh.size());
  for (int e = 0; e < mesh.size(); ++e) {
    Vector3d middle = Vector3d::Zero();
    for (int a = 0; a < 4; ++a) middle += mesh.X.col(mesh.elements(a, e)) / 4.0;
    weight[e] = spec.blend->of(middle);
  }
  return weight;
}

/// No element may be without a law.
void check_cover(const EnergyModel& energy, const Capture& capture, const TetMesh& mesh) {
  VectorXd sum = VectorXd::Zero(mesh.size());
  for (const auto& part : energy.parts)
    if (part.weight.size() == 0)
      sum.array() += 1.0;
    else
      sum += part.weight;
  Eigen::Index least = 0;
  if (sum.size() == 0 || sum.minCoeff(&least) > 0.0) return;
  const Vector3d X = mesh.X.col(mesh.elements(0, static_cast<int>(least)));
  throw InputError(capture.materials.front().place,
                   fmt::format("{} elements have no material, one of them at ({:.4g}, {:.4g}, "
                               "{:.4g})",
                               (sum.array() <= 0.0).count(), X.x(), X.y(), X.z()),
                   "every part of the body needs a law with a weight above zero");
}

PhotoState told_photo(const Capture& capture, const PhotoSpec& spec) {
  PhotoState state;
  state.camera = capture.camera(spec.camera);
  state.shaded = capture.body.texture != BodySpec::Texture::rest;
  if (state.shaded) {
    const double albedo = capture.body.texture == BodySpec::Texture::uniform
                              ? capture.body.uniform_albedo.value_or(0.5)
                              : 1.0;
    state.ambient = albedo * capture.light.ambient;
    state.uneven = albedo * capture.light.uneven;
    state.sun = albedo * capture.light.sun;
  }
  if (spec.background.kind == BackgroundSpec::Kind::level) state.background = spec.background.level;
  return state;
}

/// Silhouettes have neither light nor albedo.
bool any_image(const Capture& capture) {
  for (const auto& example : capture.examples)
    for (const auto& photo : example.photos)
      if (photo.kind == PhotoSpec::Kind::image) return true;
  return false;
}

Model told_model(std::shared_ptr<const Scene> scene) {
  const Capture& capture = scene->capture;
  const TetMesh& mesh = scene->body->mesh;
  Model model;
  model.scene = scene;
  for (const auto& spec : capture.materials) {
    model.energy.parts.push_back({make_law(spec), element_weights(mesh, spec)});
    set_frames(model.energy.parts.back(), mesh);
  }
  check_cover(model.energy, capture, mesh);
  for (const auto& spec : capture.examples) {
    ExampleModel example;
    example.loading = make_loading(capture, spec, mesh, scene->body->regions);
    for (const auto& photo : spec.photos) example.photos.push_back(told_photo(capture, photo));
    model.examples.push_back(std::move(example));
  }
  return model;
}

}  // namespace

ModelForm base_form(std::shared_ptr<const Scene> scene) {
  const Capture& capture = scene->capture;
  ModelForm form;
  form.scene = scene;
  form.start = told_model(scene);
  form.ingredients = material_ingredients(*scene, form.start.energy);
  if (auto rigid = rigid_support_ingredient(*scene)) form.ingredients.push_back(rigid);
  if (auto travels = travel_ingredient(*scene)) form.ingredients.push_back(travels);
  const bool shaded = any_image(capture) && (capture.body.texture == BodySpec::Texture::image ||
                                             capture.body.texture == BodySpec::Texture::uniform);
  // A light that is fitted whole has the albedo in it; told beside it, a sun tells that apart.
  const bool told_light = capture.light.given || !capture.light.sun.isZero(0.0);
  if (shaded && told_light && capture.body.texture == BodySpec::Texture::uniform &&
      !capture.body.uniform_albedo)
    form.ingredients.push_back(albedo_ingredient());
  if (shaded && !capture.light.given) form.ingredients.push_back(light_ingredient(*scene));
  if (auto levels = background_ingredient(*scene)) form.ingredients.push_back(levels);
  if (auto lenses = lens_ingredient(*scene)) form.ingredients.push_back(lenses);
  if (auto cameras = calibration_ingredient(*scene)) form.ingredients.push_back(cameras);
  if (capture.body.fit_placement) form.ingredients.push_back(placement_ingredient(*scene));
  // Gravity last: it is told in the world, and the placement turns the body against it.
  if (capture.gravity) form.ingredients.push_back(self_weight_ingredient(*capture.gravity));
  return form;
}

}  // namespace hookeye
