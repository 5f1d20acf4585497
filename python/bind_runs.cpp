#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "core/json_file.h"
#include "estimation/evaluation/normal_equations.h"
#include "python/arrays.h"
#include "python/errors.h"
#include "python/field_arrays.h"
#include "python/runs.h"
#include "python/verbs.h"
#include "runs/decision_log.h"
#include "runs/report/answer.h"
#include "runs/report/write_report.h"

namespace hookeye {

namespace py = pybind11;

namespace {

using SharedRun = std::shared_ptr<OpenedRun>;
using std::filesystem::path;

/// Calls `body` beside other Python threads, alone with the run.
template <class Body>
auto alone_with(const SharedRun& run, Work& work, const Body& body) {
  const auto alone = work.alone_with(run->working);
  return work.run(body);
}

SharedRun fit_capture(std::shared_ptr<OpenedCapture> capture, std::shared_ptr<PythonModel> model,
                      const path& out, std::optional<int> iterations, bool additive,
                      const std::string& command, py::object on_step, py::object cancel) {
  if (model && model->capture() != capture)
    bad_argument("the model is of another capture", "make it by capture.model()");
  if (iterations && *iterations < 1)
    bad_argument("iterations: " + std::to_string(*iterations), "a whole number from 1");
  Work work(std::move(cancel));
  const Listener listener(work, std::move(on_step));
  PythonFit wanted{std::move(capture), {}, out, iterations, additive, command};
  if (model) wanted.model = model->state();
  return work.run([&] { return fit_into(wanted, listener, work); });
}

SharedRun discover_run(std::shared_ptr<OpenedCapture> capture, const path& out,
                       std::vector<std::string> without, const std::string& command,
                       py::object on_step, py::object cancel) {
  Work work(std::move(cancel));
  const Listener listener(work, std::move(on_step));
  const PythonSearch wanted{std::move(capture), out, std::move(without), command};
  return work.run([&] { return search_into(wanted, listener, work); });
}

py::object diagnose_it(const SharedRun& run, py::object on_step, py::object cancel) {
  Work work(std::move(cancel));
  const Listener listener(work, std::move(on_step));
  return python_of(alone_with(run, work, [&] { return diagnose_run(*run, listener, work); }));
}

void add_to_it(const SharedRun& run, const std::string& effect, bool take_back,
               const std::string& command, py::object on_step, py::object cancel) {
  Work work(std::move(cancel));
  const Listener listener(work, std::move(on_step));
  alone_with(run, work, [&] {
    add_to_run(*run, effect, take_back, command, listener);
    return true;
  });
}

py::dict timeline_of(const SharedRun& opened) {
  const Run run = open_run(opened->folder(), false);
  py::list steps;
  for (const path& step : run.steps()) steps.append(step.string());
  const nlohmann::json answer =
      run.steps().empty() ? nlohmann::json() : answer_of(run.folder(), run.timeline());
  py::dict out;
  out["timeline"] = python_of(run.timeline());
  out["capture"] = run.capture().string();
  out["steps"] = steps;
  out["answer"] = python_of(answer);
  out["text"] = answer.is_null() ? "" : answer_text(answer);
  return out;
}

py::object decisions_in(const SharedRun& opened) {
  const Run run = open_run(opened->folder(), false);
  nlohmann::json out = nlohmann::json::array();
  for (const path& step : run.steps())
    for (const Decision& one : decisions_of(step)) {
      nlohmann::json line = to_json(one);
      line["step"] = step.filename().string();
      out.push_back(std::move(line));
    }
  return python_of(out);
}

py::object report_it(const SharedRun& run, const path& out, py::object on_step, py::object cancel) {
  Work work(std::move(cancel));
  WriteReport told;
  told.cancel = work.cancelled();
  if (!on_step.is_none())
    told.progress = [&](int done, int of) {
      work.tell([&] { on_step("report", "", done, of, 0.0); });
    };
  return python_of(work.run([&] { return write_report(run->folder(), out, told); }));
}

/// Of the newest step: names, values, what is positive, covariance of what the data fix.
py::dict covariance_of(const SharedRun& run, py::object cancel) {
  Work work(std::move(cancel));
  FitOptions options;
  options.cancel = work.cancelled();
  const auto [parameters, p, all] = alone_with(run, work, [&] {
    const Fitted& fitted = run->newest(options)->fitted;
    const auto own = fitted.form.parameters();
    return std::make_tuple(own, VectorXd(fitted.p),
                           parameter_covariance(fitted.evaluation, own, fitted.p));
  });
  py::list names, positive, low, high;
  for (const Parameter& one : parameters) {
    names.append(one.name);
    positive.append(one.positive);
    low.append(one.low);
    high.append(one.high);
  }
  py::dict out;
  out["names"] = names;
  out["positive"] = positive;
  out["low"] = low;
  out["high"] = high;
  out["values"] = array_of(p);
  out["covariance"] = array_of(all.determined);
  out["undetermined"] = array_of(all.undetermined);
  out["directions"] = py::cast(all.directions);
  return out;
}

/// Residuals over noise of the newest step by (example, camera, plane), held-out photos too.
py::list residuals_of(const SharedRun& run, py::object cancel) {
  Work work(std::move(cancel));
  FitOptions options;
  options.cancel = work.cancelled();
  const auto step = alone_with(run, work, [&] { return run->newest(options); });
  const Capture& capture = step->fitted.form.scene->capture;
  py::list out;
  for (const ExampleEvaluation& example : step->fitted.evaluation.examples)
    for (const PhotoEvaluation& photo : example.photos) {
      const ExampleSpec& spec = capture.examples[static_cast<size_t>(photo.example)];
      out.append(py::make_tuple(spec.name, spec.photos[static_cast<size_t>(photo.photo)].camera,
                                photo.plane, example.held_out, image_array(photo.residual),
                                image_array(photo.model)));
    }
  return out;
}

/// Measured fields of the newest step, held-out ones too.
py::list fields_of_step(const SharedRun& run, py::object cancel) {
  Work work(std::move(cancel));
  FitOptions options;
  options.cancel = work.cancelled();
  const auto step = alone_with(run, work, [&] { return run->newest(options); });
  return fields_seen(step->fitted.form.scene->capture, step->fitted.evaluation);
}

/// Rest positions, elements, boundary, and displacement by example, of the newest step.
py::dict states_of(const SharedRun& run, py::object cancel) {
  Work work(std::move(cancel));
  FitOptions options;
  options.cancel = work.cancelled();
  const auto step = alone_with(run, work, [&] { return run->newest(options); });
  const Scene& scene = *step->fitted.form.scene;
  const TetMesh& mesh = scene.body->mesh;
  const Model model = step->fitted.form.realise(step->fitted.p);
  py::dict displacement, von_mises, out;
  for (const ExampleEvaluation& example : step->fitted.evaluation.examples) {
    if (!example.equilibrium) continue;
    const auto name = py::str(scene.capture.examples[static_cast<size_t>(example.example)].name);
    const VectorXd& q = example.equilibrium->q;
    displacement[name] = points_array(q.reshaped(3, mesh.nodes()) - mesh.X);
    const ElementState state = element_state(mesh, model.energy_of(example.example), q);
    von_mises[name] = array_of(Eigen::VectorXd(state.von_mises));
  }
  out["points"] = points_array(mesh.X);
  out["elements"] = int_rows(mesh.elements);
  out["boundary"] = int_rows(mesh.boundary);
  out["displacement"] = displacement;
  out["von_mises"] = von_mises;
  return out;
}

std::shared_ptr<PythonModel> model_of(const SharedRun& run, py::object cancel) {
  Work work(std::move(cancel));
  FitOptions options;
  options.cancel = work.cancelled();
  return alone_with(run, work, [&] {
    const Fitted& fitted = run->newest(options)->fitted;
    return std::make_shared<PythonModel>(run->capture(), fitted.form, fitted.p);
  });
}

}  // namespace

void bind_runs(py::module_& m) {
  py::class_<OpenedRun, SharedRun>(m, "Run")
      .def(py::init([](const path& folder) { return std::make_shared<OpenedRun>(folder); }),
           py::arg("folder"))
      .def_property_readonly("folder", [](const OpenedRun& r) { return r.folder().string(); })
      .def("timeline", &timeline_of)
      .def("decisions", &decisions_in)
      .def("diagnose", &diagnose_it, py::arg("on_step"), py::arg("cancel"))
      .def("add", &add_to_it, py::arg("effect"), py::arg("take_back"), py::arg("command"),
           py::arg("on_step"), py::arg("cancel"))
      .def("report", &report_it, py::arg("out"), py::arg("on_step"), py::arg("cancel"))
      .def("covariance", &covariance_of, py::arg("cancel"))
      .def("residuals", &residuals_of, py::arg("cancel"))
      .def("fields", &fields_of_step, py::arg("cancel"))
      .def("states", &states_of, py::arg("cancel"))
      .def("model", &model_of, py::arg("cancel"));
  m.def("fit", &fit_capture, py::arg("capture"), py::arg("model"), py::arg("out"),
        py::arg("iterations"), py::arg("additive"), py::arg("command"), py::arg("on_step"),
        py::arg("cancel"));
  m.def("discover", &discover_run, py::arg("capture"), py::arg("out"), py::arg("without"),
        py::arg("command"), py::arg("on_step"), py::arg("cancel"));
}

}  // namespace hookeye
