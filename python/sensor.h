// Sensors written in Python: those of estimation/model/session_sensors.h.
#pragma once

#include <pybind11/pybind11.h>

namespace hookeye {

void bind_sensors(pybind11::module_& m);

}  // namespace hookeye
