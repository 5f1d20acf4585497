#include <pybind11/stl.h>

#include "capture_io/field_start.h"
#include "estimation/effects/catalogue.h"
#include "estimation/evaluation/normal_equations.h"
#include "python/arrays.h"
#include "python/equilibrium.h"
#include "python/field_arrays.h"
#include "python/model.h"

namespace hookeye {

namespace py = pybind11;

namespace {

using SharedModel = std::shared_ptr<PythonModel>;

py::list parameters_of(const PythonModel& model) {
  py::list out;
  const auto all = model.parameters();
  for (size_t i = 0; i < all.size(); ++i) {
    py::dict one;
    one["name"] = all[i].name;
    one["unit"] = all[i].unit;
    one["words"] = all[i].long_name;
    one["value"] = model.values()[static_cast<Eigen::Index>(i)];
    one["low"] = all[i].low;
    one["high"] = all[i].high;
    one["typical"] = all[i].typical;
    one["positive"] = all[i].positive;
    one["fixed"] = model.is_fixed(all[i].name);
    out.append(one);
  }
  return out;
}

/// Planes of one photo together.
py::object stacked(const std::vector<PhotoEvaluation>& photos, size_t first, size_t planes,
                   Image PhotoEvaluation::*member) {
  Image all = photos[first].*member;
  if (planes > 1) {
    const Image one = all;
    all.channels = static_cast<int>(planes);
    all.values.resize(one.pixels() * planes);
    for (size_t c = 0; c < planes; ++c)
      for (size_t i = 0; i < one.pixels(); ++i)
        all.values[i * planes + c] = (photos[first + c].*member).values[i];
  }
  return image_array(all);
}

py::list measured_list(const ExampleEvaluation& example, const Capture& capture) {
  py::list out;
  const ExampleSpec& spec = capture.examples[static_cast<size_t>(example.example)];
  for (const MeasuredEvaluation& one : example.measured) {
    const MeasuredSpec& told = spec.measured[static_cast<size_t>(one.index)];
    py::dict d;
    d["example"] = spec.name;
    d["kind"] = kind_of(told).name;
    d["region"] = told.field ? "" : told.region;
    if (!start_of(told).empty()) d["from"] = start_of(told);
    d["value"] = array_of(Eigen::VectorXd(told.value));
    d["predicted"] = array_of(Eigen::VectorXd(one.predicted));
    d["r"] = array_of(Eigen::VectorXd(one.r));
    out.append(d);
  }
  return out;
}

py::dict evaluation_dict(const Evaluation& evaluation, const Capture& capture, bool derivatives) {
  py::dict r, pictures, out;
  py::list measured;
  for (const ExampleEvaluation& example : evaluation.examples) {
    const ExampleSpec& spec = capture.examples[static_cast<size_t>(example.example)];
    for (size_t i = 0, planes = 1; i < example.photos.size(); i += planes) {
      const int photo = example.photos[i].photo;
      for (planes = 1; i + planes < example.photos.size(); ++planes)
        if (example.photos[i + planes].photo != photo) break;
      const auto key = py::make_tuple(spec.name, spec.photos[static_cast<size_t>(photo)].camera);
      r[key] = stacked(example.photos, i, planes, &PhotoEvaluation::residual);
      pictures[key] = stacked(example.photos, i, planes, &PhotoEvaluation::model);
    }
    for (const auto& one : measured_list(example, capture)) measured.append(one);
  }
  double r2 = 0.0;
  for (const ExampleEvaluation& example : evaluation.examples) {
    if (example.held_out) continue;
    for (const PhotoEvaluation& photo : example.photos) r2 += photo.r2;
    for (const MeasuredEvaluation& one : example.measured) r2 += one.r.squaredNorm();
  }
  out["r"] = r;
  out["pictures"] = pictures;
  out["measured"] = measured;
  out["fields"] = fields_seen(capture, evaluation);
  out["r2"] = r2;
  out["chi"] = evaluation.chi(false);
  out["chi_held_out"] = evaluation.chi(true);
  if (!derivatives) return out;
  const NormalEquations sums = normal_equations(evaluation);
  const CondensedResidual condensed = condense(sums, VectorXd::Ones(sums.Jtr.size()));
  out["JTJ"] = array_of(sums.JtJ);
  out["JTr"] = array_of(Eigen::VectorXd(sums.Jtr));
  out["R"] = array_of(Eigen::MatrixXd(condensed.R));
  out["z"] = array_of(Eigen::VectorXd(condensed.z));
  out["rho"] = condensed.rho;
  return out;
}

py::dict evaluated(const SharedModel& model, bool jac, bool held_out, py::object cancel) {
  Work work(std::move(cancel));
  const ModelState state = model->state();
  const auto alone = work.alone_with(model->working);
  const Evaluation evaluation =
      work.run([&] { return evaluate(model->workspace(), state, jac, held_out, work); });
  std::vector<std::string> names;
  for (const Parameter& one : state.form.parameters()) names.push_back(one.name);
  py::dict out = evaluation_dict(evaluation, state.form.scene->capture, jac);
  out["names"] = names;
  return out;
}

py::tuple rendered(const SharedModel& model, const std::string& example, const std::string& camera,
                   py::object cancel) {
  Work work(std::move(cancel));
  const ModelState state = model->state();
  const Sighting seen = work.run([&] { return render(state, example, camera, work); });
  return py::make_tuple(image_array(seen.picture), image_array(seen.coverage));
}

std::shared_ptr<SolvedExample> simulated(const SharedModel& model, const std::string& example,
                                         py::object cancel) {
  Work work(std::move(cancel));
  const ModelState state = model->state();
  return work.run([&] { return simulate(state, example, work); });
}

/// Energies, forces, tangents along a direction and other numbers of all examples at x (n x 3).
py::dict probed(const SharedModel& model, const py::object& x, const py::object& along) {
  const VectorXd q = points_from(x, "x").reshaped(), v = points_from(along, "along").reshaped();
  Work work{py::none()};
  const ModelState state = model->state();
  const Probed at = work.run([&] { return probe(state, q, v); });
  py::dict out;
  out["energy"] = array_of(at.energy);
  out["forces"] = array_of(Eigen::MatrixXd(at.forces.transpose()));
  out["tangent"] = array_of(Eigen::MatrixXd(at.tangent.transpose()));
  out["numbers"] = array_of(at.numbers);
  return out;
}

}  // namespace

void bind_model(py::module_& m) {
  py::class_<PythonModel, SharedModel>(m, "Model")
      .def(py::init([](const std::shared_ptr<OpenedCapture>& capture, py::object cancel) {
             Work work(std::move(cancel));
             return work.run([&] { return std::make_shared<PythonModel>(capture); });
           }),
           py::arg("capture"), py::arg("cancel") = py::none())
      .def_property_readonly("capture", &PythonModel::capture)
      .def("parameters", &parameters_of)
      .def("set", &PythonModel::set, py::arg("name"), py::arg("value"))
      .def("fix", &PythonModel::fix, py::arg("name"))
      .def("free", &PythonModel::free, py::arg("name"))
      .def("add", &PythonModel::add, py::arg("effect"), py::arg("variant"))
      .def("remove", &PythonModel::remove, py::arg("effect"))
      .def("variants", &PythonModel::variants, py::arg("effect"))
      .def("ingredients", &PythonModel::ingredients)
      .def("text", &PythonModel::text)
      .def("probe", &probed, py::arg("x"), py::arg("along"))
      .def("simulate", &simulated, py::arg("example"), py::arg("cancel"))
      .def("render", &rendered, py::arg("example"), py::arg("camera"), py::arg("cancel"))
      .def("evaluate", &evaluated, py::arg("jac"), py::arg("held_out"), py::arg("cancel"));
}

}  // namespace hookeye
