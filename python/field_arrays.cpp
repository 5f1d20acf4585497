#include "python/field_arrays.h"

#include <pybind11/stl.h>

#include "capture_io/component_sigmas.h"
#include "capture_io/field_rows.h"
#include "capture_io/field_start.h"
#include "capture_io/strain_field.h"
#include "python/arrays.h"

namespace hookeye {

namespace py = pybind11;

namespace {

/// Numbers point by point, points x components.
DoubleArray rows_of_points(const VectorXd& values, int components) {
  DoubleArray out({values.size() / components, Eigen::Index{components}});
  std::copy(values.data(), values.data() + values.size(), out.mutable_data());
  return out;
}

py::dict field_dict(const Capture& capture, const ExampleSpec& example,
                    const MeasuredSpec& measured) {
  const FieldSpec& field = *measured.field;
  const std::vector<std::string> names = field.strain
                                             ? std::vector<std::string>{"exx", "eyy", "exy"}
                                             : std::vector<std::string>{"x", "y", "z"};
  py::dict out;
  out["example"] = example.name;
  out["file"] = field.file.lexically_relative(capture.folder).generic_string();
  out["held_out"] = example.validate;
  out["holds"] = field.strain ? "strains" : "displacements";
  out["measure"] = field.strain ? name_of(field.strain->measure) : std::string();
  out["from"] = start_of(measured);
  out["unit"] = field.strain ? std::string() : capture.units.length;
  out["components"] = std::vector<std::string>(names.begin(), names.begin() + field.components);
  out["axes"] = field.strain ? array_of(Eigen::MatrixXd(field.strain->axes))
                             : array_of(Eigen::MatrixXd(field.axes));
  out["lines"] = py::array_t<int>(static_cast<py::ssize_t>(field.lines.size()), field.lines.data());
  const std::vector<int> dropped = dropped_lines(capture, measured);
  out["dropped_lines"] = py::array_t<int>(static_cast<py::ssize_t>(dropped.size()), dropped.data());
  out["points"] = points_array(field.X);
  out["measured"] = rows_of_points(measured.value, field.components);
  out["sigma"] = array_of(VectorXd(component_sigmas(measured)));
  out["alike"] = array_of(field.alike);
  return out;
}

}  // namespace

py::list fields_told(const Capture& capture) {
  py::list out;
  for (const ExampleSpec& example : capture.examples)
    for (const MeasuredSpec& measured : example.measured)
      if (measured.field && !example.test) out.append(field_dict(capture, example, measured));
  return out;
}

py::list fields_seen(const Capture& capture, const Evaluation& evaluation) {
  py::list out;
  for (const ExampleEvaluation& example : evaluation.examples)
    for (const MeasuredEvaluation& one : example.measured) {
      if (!one.is_field()) continue;
      const ExampleSpec& told = capture.examples[static_cast<size_t>(example.example)];
      const MeasuredSpec& measured = told.measured[static_cast<size_t>(one.index)];
      py::dict field = field_dict(capture, told, measured);
      field["predicted"] = rows_of_points(one.predicted, measured.field->components);
      out.append(field);
    }
  return out;
}

}  // namespace hookeye
