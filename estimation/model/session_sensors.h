// Sensors that a program adds while it runs: those written in Python. A capture names them by
// `measured: - {sensor: NAME, value, sigma}`.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "capture_io/capture.h"
#include "estimation/model/model.h"

namespace hookeye {

/// Where what a sensor looks at is, in the frame that cameras stand in: points in a row, xyz xyz.
struct SensedMotion {
  std::string example;
  std::vector<int> counts;  ///< points of each region, in their order; of points: one count
  VectorXd x, u;            ///< positions; displacements from where the body was given [length]
  Eigen::MatrixXd dx, du;   ///< their derivatives, a column each; no columns: none are asked for
};

struct SensorAnswer {
  VectorXd value;
  Eigen::MatrixXd J;  ///< a column for each of the motion's
};

/// What it is asked from any thread. Its numbers are those of the motion alone.
class SessionSensor {
 public:
  virtual ~SessionSensor() = default;
  virtual std::string name() const = 0;
  virtual std::string unit() const = 0;  ///< of its numbers; for people
  /// It sees all nodes of these; none: it sees points().
  virtual std::vector<std::string> regions() const = 0;
  /// On the body as it was given; the nearest points of its surface are taken.
  virtual Matrix3Xd points() const = 0;
  virtual SensorAnswer answer(const SensedMotion& motion) const = 0;
};

/// Adds a sensor, or puts it in the place of one of the same name. `code`: tells one definition
/// from another. Thread-safe; whoever works with the one of before goes on with it.
void add_sensor(std::shared_ptr<const SessionSensor> sensor, const std::string& code);
/// Takes it out again. False: there was none of this name.
bool take_sensor(const std::string& name);
/// Null where there is none.
std::shared_ptr<const SessionSensor> find_sensor(const std::string& name);
/// "NAME CODE" of each: what was worked out under others may come out otherwise.
std::vector<std::string> added_sensors();

/// Whether it is one of these; their name is MeasuredSpec::region.
inline bool by_sensor(const MeasuredSpec& measured) {
  return measured.kind == MeasuredSpec::Kind::sensor;
}
/// What a measurement is in: unit_of(), and a sensor's own.
std::string measured_unit(const MeasuredSpec& measured, const Units& units);

/// Throws InputError where an example names a sensor that nobody has added, or one that looks at a
/// region which the capture does not have.
void check_sensors(const Capture& capture, const ExampleSpec& example);

}  // namespace hookeye
