#include "estimation/effects_scene.h"

#include "estimation/model/declaration.h"
#include "simulation/equilibrium.h"
#include "support/temporary_folder.h"

namespace hookeye::test {

namespace {

std::shared_ptr<const Scene> read_block() {
  // The body's surface is read again for another mesh: the folder goes with the program.
  static const TemporaryFolder folder;
  write_example_block(folder.path());
  return load_scene(read_capture(folder.path()));
}

Eigen::Matrix3d quarter() {
  Eigen::Matrix3d R;
  R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  return R;
}

}  // namespace

std::shared_ptr<const Scene> block_scene() {
  static const auto scene = read_block();
  return scene;
}

Eigen::Vector3d quarter_turn(const Eigen::Vector3d& x) { return {-x.y(), x.x(), x.z()}; }

std::shared_ptr<const Scene> turned_scene() {
  static const auto turned = [] {
    auto scene = std::make_shared<Scene>(*block_scene());
    auto body = std::make_shared<Body>(*scene->body);
    body->mesh.X = quarter() * body->mesh.X;
    body->surface.mesh.X = quarter() * body->surface.mesh.X;
    // Regions are chosen again by the turned boxes.
    for (auto& spec : scene->capture.regions) {
      auto& box = std::get<RegionSpec::Box>(spec.shape);
      const Vector3d a = quarter_turn(box.low), b = quarter_turn(box.high);
      box.low = a.cwiseMin(b);
      box.high = a.cwiseMax(b);
    }
    body->regions = RegionSet(scene->capture, body->mesh, nullptr);
    for (auto& example : scene->capture.examples) {
      for (auto& load : example.loads)
        if (load.force) load.force = quarter_turn(*load.force);
      for (auto& support : example.supports) {
        support.rigid.axis = quarter_turn(support.rigid.axis);
        support.rigid.center = quarter_turn(support.rigid.center);
        support.rigid.move = quarter_turn(support.rigid.move);
      }
    }
    scene->body = body;
    return scene;
  }();
  return turned;
}

VectorXd deformed_state(const Scene& scene) {
  const Matrix3Xd& X0 = block_scene()->body->mesh.X;
  VectorXd q(X0.size());
  for (int a = 0; a < X0.cols(); ++a) {
    const Vector3d X = X0.col(a);
    Vector3d u(0.002 * X.z() * X.z() + 0.01 * X.x(), -0.0015 * X.x() * X.z() + 0.02 * X.y(),
               0.06 * X.z() + 0.004 * X.x() * X.y() - 0.0006 * X.z() * X.z());
    u.y() -= 0.001 * X.z() * X.z();
    const Vector3d x = X + u;
    q.segment<3>(3 * a) = &scene == block_scene().get() ? x : quarter_turn(x);
  }
  return q;
}

VectorXd signature(const Model& model, const VectorXd& q) {
  const TetMesh& mesh = model.scene->body->mesh;
  std::vector<double> all;
  auto append = [&](const auto& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) all.push_back(values(i));
  };
  for (size_t e = 0; e < model.examples.size(); ++e) {
    const ExampleModel& example = model.examples[e];
    append(residual(mesh, model.energy_of(static_cast<int>(e)), example.loading, q));
    append(example.loading.displacement);
    for (int unknown : example.loading.prescribed) all.push_back(unknown);
    for (const auto& photo : example.photos) {
      append(photo.camera.R.reshaped());
      append(photo.camera.t);
      append(photo.sun);
      append(photo.uneven);
      for (double x : {photo.camera.fx, photo.camera.fy, photo.gain, photo.ambient, photo.specular,
                       photo.blur_variance, photo.background, photo.shininess})
        all.push_back(x);
    }
    append(example.force_offset);
  }
  append(model.placement.matrix().reshaped());
  return Eigen::Map<VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

Model with_states(Model model) {
  for (size_t e = 0; e < model.examples.size(); ++e) {
    if (model.scene->capture.examples[e].validate) continue;
    auto solved = solve_equilibrium(model.scene->body->mesh, model.energy_of(static_cast<int>(e)),
                                    model.examples[e].loading);
    model.states.push_back(std::make_shared<Equilibrium>(*std::move(solved)));
  }
  return model;
}

const ModelForm& base() {
  static const ModelForm form = base_form(block_scene());
  return form;
}

const Model& base_model() {
  static const Model model = with_states(base().realise(base().initial()));
  return model;
}

ModelForm extended(const ModelForm& base, std::shared_ptr<const Ingredient> ingredient) {
  ModelForm form = base;
  form.ingredients.push_back(std::move(ingredient));
  return form;
}

VectorXd with_values(const ModelForm& form, const VectorXd& values) {
  VectorXd p = form.initial();
  p.tail(values.size()) = values;
  return p;
}

VectorXd null_values(const Ingredient& ingredient) {
  const auto parameters = ingredient.parameters();
  VectorXd values(parameters.size());
  for (size_t i = 0; i < parameters.size(); ++i) values[i] = parameters[i].value;
  return values;
}

VectorXd some_values(const Ingredient& ingredient) {
  const auto parameters = ingredient.parameters();
  VectorXd values(parameters.size());
  for (size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& p = parameters[i];
    const double step = (0.3 + 0.1 * static_cast<double>(i % 4)) * p.typical;
    values[i] = p.positive ? 1.3 * p.value : p.value + step;
    if (values[i] > p.high) values[i] = p.value - step;
  }
  return values;
}

std::shared_ptr<const Scene> additive_block(std::vector<std::string> fit) {
  auto scene = std::make_shared<Scene>(*block_scene());
  MaterialSpec& spec = scene->capture.materials.at(0);
  spec.law = "additive";
  spec.parameters.clear();
  const auto tell = [&](const std::string& key, std::vector<double> numbers) {
    spec.parameters[key] = {std::move(numbers), spec.place};
  };
  tell("I1bar.at", {0, 0.4});
  tell("I1bar.stiffness", {0.05, 0.08});
  tell("J.at", {-0.1, 0.1});
  tell("J.stiffness", {0.6, 0.5});
  tell("E33.at", {-0.1, 0, 0.2});
  tell("E33.stiffness", {0.02, 0.03, 0.06});
  tell("E11.at", {0});
  tell("E11.stiffness", {0.02});
  tell("E11_E33.at", {0});
  tell("E11_E33.at_2", {0});
  tell("E11_E33.stiffness", {0.01});
  tell("barrier.modulus", {0.5});
  tell("barrier.below", {0.3});
  scene->capture.fit_places.assign(fit.size(), spec.place);
  scene->capture.fit = std::move(fit);
  return scene;
}

}  // namespace hookeye::test
