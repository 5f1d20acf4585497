#include "python/equilibrium.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/scope.h"
#include "estimation/effects/catalogue.h"
#include "python/arrays.h"
#include "python/errors.h"
#include "runs/failed.h"

namespace hookeye {

namespace py = pybind11;

namespace {

[[noreturn]] void unknown(const std::string& what, const std::string& wanted,
                          const std::vector<std::string>& known) {
  const std::string near = nearest_name(wanted, known);
  bad_argument(fmt::format("there is no {} '{}'", what, wanted),
               near.empty() ? fmt::format("one of {}", fmt::join(known, ", "))
                            : fmt::format("did you mean '{}'?", near));
}

int example_of(const Capture& capture, const std::string& wanted) {
  std::vector<std::string> known;
  for (const ExampleSpec& one : capture.examples) {
    if (one.name == wanted) return static_cast<int>(known.size());
    known.push_back(one.name);
  }
  unknown("example", wanted, known);
}

Equilibrium solved(const Model& model, int e, const Work& work) {
  const std::string& name = model.scene->capture.examples[e].name;
  const Scope scope("example " + name);
  EquilibriumOptions options;
  options.cancelled = [&] { return work.cancelled()->load(); };
  EquilibriumSolver solver(model.scene->mesh());
  auto state = solver.solve(model.energy_of(e), model.examples[e].loading, options);
  if (!state) {
    state.error().example = name;
    fail(std::move(state.error()));
  }
  return *std::move(state);
}

/// The same model of a scene with other examples or photos.
Model of_scene(const ModelState& model, std::shared_ptr<const Scene> scene) {
  const auto [form, p] = transfer(model.realise(), std::move(scene), catalogue());
  return form.realise(p);
}

/// With the examples of `use: test`, where it is one of those; on the model's own mesh, without
/// their photos.
Model with_example(const ModelState& model, const std::string& example) {
  const Model own = model.realise();
  if (own.scene->example_index(example) >= 0) return own;
  example_of(model.capture->capture(), example);  // or it is not known at all
  auto whole = std::make_shared<Scene>(*own.scene);
  for (const ExampleSpec& one : model.capture->capture().examples)
    if (one.test) whole->capture.examples.push_back(one);
  whole->photos.resize(whole->capture.examples.size());
  return of_scene(model, std::move(whole));
}

int photo_of(const ExampleSpec& example, const std::string& camera) {
  std::vector<std::string> known;
  for (const PhotoSpec& photo : example.photos) {
    if (photo.camera == camera) return static_cast<int>(known.size());
    known.push_back(photo.camera);
  }
  unknown("camera of example " + example.name, camera, known);
}

/// Where the texture is no photo every camera can look at every example.
Model looking(const ModelState& model, const std::string& example) {
  Model own = with_example(model, example);
  if (own.scene->capture.body.texture == BodySpec::Texture::rest) return own;
  auto scene = std::make_shared<Scene>(*own.scene);
  look_with_all_cameras(scene->capture);
  for (size_t e = 0; e < scene->photos.size(); ++e) scene->photos[e].clear();
  return of_scene(model, std::move(scene));
}

}  // namespace

std::shared_ptr<SolvedExample> simulate(const ModelState& model, const std::string& example,
                                        const Work& work) {
  auto out = std::make_shared<SolvedExample>();
  out->model = with_example(model, example);
  out->example = example_of(out->model.scene->capture, example);
  out->state = solved(out->model, out->example, work);
  return out;
}

Sighting render(const ModelState& model, const std::string& example, const std::string& camera,
                const Work& work) {
  const Model seen = looking(model, example);
  const Capture& capture = seen.scene->capture;
  const int e = example_of(capture, example);
  const int k = photo_of(capture.examples[static_cast<size_t>(e)], camera);
  const VectorXd q = solved(seen, e, work).q;
  const int reference = capture.body.texture == BodySpec::Texture::rest
                            ? seen.scene->example_index(capture.body.texture_example)
                            : -1;
  VectorXd q_reference;
  if (reference >= 0) q_reference = solved(seen, reference, work).q;
  PhotoComparer comparer(seen.scene, e);
  return look(comparer, seen, e, k, q, reference >= 0 ? &q_reference : nullptr);
}

Evaluation evaluate(Workspace& workspace, const ModelState& model, bool derivatives, bool held_out,
                    const Work& work) {
  EvaluationOptions options;
  options.derivatives = derivatives;
  options.residuals = true;
  options.held_out = held_out;
  options.cancel = work.cancelled();
  return value_or_fail(workspace.evaluate(model.form, model.p, options));
}

Probed probe(const ModelState& state, const VectorXd& q, const VectorXd& along) {
  const Model model = state.realise();
  const TetMesh& mesh = model.scene->body->mesh;
  if (q.size() != 3 * mesh.nodes() || along.size() != q.size())
    bad_argument("probe: not a row for each node", fmt::format("{} x 3", mesh.nodes()));
  const auto count = static_cast<Eigen::Index>(model.examples.size());
  Probed out{
      VectorXd(count), Eigen::MatrixXd(q.size(), count), Eigen::MatrixXd(q.size(), count), {}};
  std::vector<double> numbers;
  const auto append = [&](const auto& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) numbers.push_back(values(i));
  };
  for (Eigen::Index e = 0; e < count; ++e) {
    const ExampleModel& one = model.examples[static_cast<size_t>(e)];
    const EnergyModel energy = model.energy_of(static_cast<int>(e));
    out.energy[e] = internal_energy(mesh, energy, q);
    out.forces.col(e) = residual(mesh, energy, one.loading, q);
    out.tangent.col(e) = tangent(mesh, energy, one.loading, q) * along;
    append(one.loading.displacement);
    append(one.force_offset);
    for (const PhotoState& photo : one.photos) {
      append(photo.camera.R.reshaped());
      append(photo.camera.t);
      append(photo.sun);
      append(photo.uneven);
      for (const double x : {photo.camera.fx, photo.camera.fy, photo.gain, photo.ambient,
                             photo.specular, photo.blur_variance, photo.background})
        numbers.push_back(x);
    }
  }
  append(model.placement.matrix().reshaped());
  out.numbers =
      Eigen::Map<const VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
  return out;
}

namespace {

using Solved = std::shared_ptr<SolvedExample>;

ElementState elements_of(const SolvedExample& one) {
  return element_state(one.mesh(), one.model.energy_of(one.example), one.state.q);
}

/// Rows xx yy zz xy yz xz a column an element, as m x 3 x 3.
py::array tensors(const Eigen::MatrixXd& six) {
  constexpr int kAt[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  DoubleArray out({six.cols(), Eigen::Index{3}, Eigen::Index{3}});
  double* at = out.mutable_data();
  for (Eigen::Index e = 0; e < six.cols(); ++e)
    for (const auto& row : kAt)
      for (const int i : row) *at++ = six(i, e);
  return out;
}

py::array gradients(const SolvedExample& one) {
  const auto F = deformation_gradients(one.mesh(), one.state.q);
  const auto m = static_cast<py::ssize_t>(one.mesh().size());
  const auto points = static_cast<py::ssize_t>(F.size()) / std::max<py::ssize_t>(m, 1);
  DoubleArray out({m, points, py::ssize_t{3}, py::ssize_t{3}});
  double* at = out.mutable_data();
  for (const Eigen::Matrix3d& one_F : F)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) *at++ = one_F(i, j);
  return out;
}

const Region& region_of(const SolvedExample& one, const std::string& name) {
  const auto& all = one.model.scene->body->regions.all();
  const auto found = all.find(name);
  if (found != all.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [other, region] : all) known.push_back(other);
  unknown("region", name, known);
}

DoubleArray moment(const SolvedExample& one, const std::string& region, const py::object& about) {
  const Region& on = region_of(one, region);
  Vector3d at = on.centroid;
  if (!about.is_none()) {
    const Eigen::Matrix3Xd given = points_from(about, "about");
    if (given.cols() != 1) bad_argument("about: several points", "one point of three numbers");
    at = given.col(0);
  }
  return array_of(Eigen::VectorXd(support_moment(one.state, on, at)));
}

}  // namespace

void bind_equilibrium(py::module_& m) {
  py::class_<SolvedExample, Solved>(m, "Equilibrium")
      .def_property_readonly(
          "example",
          [](const SolvedExample& s) { return s.model.scene->capture.examples[s.example].name; })
      .def_property_readonly("points",
                             [](const SolvedExample& s) { return points_array(s.mesh().X); })
      .def_property_readonly("elements",
                             [](const SolvedExample& s) { return int_rows(s.mesh().elements); })
      .def_property_readonly("boundary",
                             [](const SolvedExample& s) { return int_rows(s.mesh().boundary); })
      .def_property_readonly(
          "u",
          [](const SolvedExample& s) {
            return points_array(s.state.q.reshaped(3, s.mesh().nodes()) - s.mesh().X);
          })
      .def_property_readonly("F", &gradients)
      .def_property_readonly(
          "stress", [](const SolvedExample& s) { return tensors(elements_of(s).cauchy_stress); })
      .def_property_readonly(
          "strain", [](const SolvedExample& s) { return tensors(elements_of(s).green_strain); })
      .def_property_readonly("von_mises",
                             [](const SolvedExample& s) {
                               return array_of(Eigen::VectorXd(elements_of(s).von_mises));
                             })
      .def_property_readonly(
          "volume_ratio",
          [](const SolvedExample& s) { return array_of(Eigen::VectorXd(elements_of(s).J)); })
      .def_property_readonly("energy_density",
                             [](const SolvedExample& s) {
                               return array_of(Eigen::VectorXd(elements_of(s).energy_density));
                             })
      .def_property_readonly("stable", [](const SolvedExample& s) { return s.state.stable; })
      .def_property_readonly("iterations",
                             [](const SolvedExample& s) { return s.state.newton_iterations; })
      .def(
          "reaction",
          [](const SolvedExample& s, const std::string& region) {
            return array_of(Eigen::VectorXd(support_force(s.state, region_of(s, region))));
          },
          py::arg("region"))
      .def("moment", &moment, py::arg("region"), py::arg("about") = py::none());
}

}  // namespace hookeye
