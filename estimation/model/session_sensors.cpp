#include "estimation/model/session_sensors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <mutex>

namespace hookeye {
namespace {

/// Kept at the program's end: an interpreter that they belong to is gone by then.
struct AddedSensors {
  struct One {
    std::shared_ptr<const SessionSensor> sensor;
    std::string code;
  };
  std::mutex mutex;
  std::map<std::string, One> all;
};

AddedSensors& added_ones() {
  static AddedSensors* const all = new AddedSensors;
  return *all;
}

}  // namespace

void add_sensor(std::shared_ptr<const SessionSensor> sensor, const std::string& code) {
  AddedSensors& added = added_ones();
  const std::string name = sensor->name();
  AddedSensors::One before;  // goes after the lock does: its end may ask for the interpreter's
  const std::lock_guard lock(added.mutex);
  before = std::exchange(added.all[name], {std::move(sensor), code});
}

bool take_sensor(const std::string& name) {
  AddedSensors& added = added_ones();
  AddedSensors::One before;
  const std::lock_guard lock(added.mutex);
  const auto known = added.all.find(name);
  if (known == added.all.end()) return false;
  before = std::move(known->second);
  added.all.erase(known);
  return true;
}

std::shared_ptr<const SessionSensor> find_sensor(const std::string& name) {
  AddedSensors& added = added_ones();
  const std::lock_guard lock(added.mutex);
  const auto known = added.all.find(name);
  return known == added.all.end() ? nullptr : known->second.sensor;
}

std::vector<std::string> added_sensors() {
  AddedSensors& added = added_ones();
  const std::lock_guard lock(added.mutex);
  std::vector<std::string> out;
  for (const auto& [name, one] : added.all) out.push_back(name + " " + one.code);
  return out;
}

std::string measured_unit(const MeasuredSpec& measured, const Units& units) {
  if (!by_sensor(measured)) return unit_of(measured, units);
  const auto sensor = find_sensor(measured.region);
  return sensor ? sensor->unit() : "";
}

void check_sensors(const Capture& capture, const ExampleSpec& example) {
  for (const MeasuredSpec& measured : example.measured) {
    if (!by_sensor(measured)) continue;
    const auto sensor = find_sensor(measured.region);
    if (!sensor)
      throw InputError(
          measured.place,
          fmt::format("there is no sensor `{}` here: it is one written in Python, and the "
                      "command line knows none",
                      measured.region),
          "work on this capture from Python, behind `hookeye.register(...)` of the class "
          "of this name (docs/python.md)");
    for (const std::string& region : sensor->regions()) {
      std::vector<std::string> known;
      for (const RegionSpec& one : capture.regions) known.push_back(one.name);
      if (std::ranges::count(known, region) == 0)
        throw InputError(measured.place,
                         fmt::format("the sensor `{}` looks at the unknown region `{}`",
                                     measured.region, region),
                         fmt::format("the capture has {}", fmt::join(known, ", ")));
    }
  }
}

}  // namespace hookeye
