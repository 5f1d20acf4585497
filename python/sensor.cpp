#include "python/sensor.h"

#include <pybind11/stl.h>

#include "estimation/model/session_sensors.h"
#include "python/bridge.h"

namespace hookeye {

namespace py = pybind11;

namespace {

/// Points of each column, m x n x 3.
DoubleArray columns_array(const Eigen::MatrixXd& columns) {
  DoubleArray out({columns.cols(), columns.rows() / 3, Eigen::Index{3}});
  std::copy(columns.data(), columns.data() + columns.size(), out.mutable_data());
  return out;
}

DoubleArray rows_array(const VectorXd& points) {
  return points_array(Eigen::Map<const Eigen::Matrix3Xd>(points.data(), 3, points.size() / 3));
}

class PythonSensor final : public SessionSensor {
 public:
  /// `told`: hookeye._sensor_bridge.SensorBridge.
  explicit PythonSensor(const py::object& told)
      : bridge_(told),
        name_(told.attr("name").cast<std::string>()),
        unit_(told.attr("unit").cast<std::string>()),
        regions_(told.attr("regions").cast<std::vector<std::string>>()) {
    if (regions_.empty()) points_ = points_from(told.attr("points"), "points");
  }

  std::string name() const override { return name_; }
  std::string unit() const override { return unit_; }
  std::vector<std::string> regions() const override { return regions_; }
  Matrix3Xd points() const override { return points_; }

  SensorAnswer answer(const SensedMotion& motion) const override {
    return bridge_.ask([&](py::handle sensor) {
      const py::tuple told =
          sensor
              .attr("answer")(rows_array(motion.x), rows_array(motion.u), columns_array(motion.dx),
                              columns_array(motion.du), motion.counts, motion.example)
              .cast<py::tuple>();
      const auto size = static_cast<Eigen::Index>(py::len(told[0]));
      SensorAnswer out;
      out.value = Bridge::rows_of(told[0], size, 1);
      if (motion.dx.cols() > 0) out.J = Bridge::rows_of(told[1], size, motion.dx.cols());
      return out;
    });
  }

 private:
  Bridge bridge_;
  std::string name_, unit_;
  std::vector<std::string> regions_;
  Matrix3Xd points_;
};

}  // namespace

void bind_sensors(py::module_& m) {
  m.def(
      "register_sensor",
      [](const py::object& bridge, const std::string& code) {
        auto sensor = std::make_shared<const PythonSensor>(bridge);
        const py::gil_scoped_release others;  // whoever asks one now holds the registry's lock
        add_sensor(std::move(sensor), code);
      },
      py::arg("bridge"), py::arg("code"));
  m.def("unregister_sensor", &take_sensor, py::arg("name"),
        py::call_guard<py::gil_scoped_release>());
}

}  // namespace hookeye
