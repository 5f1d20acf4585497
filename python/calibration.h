// hookeye.calibrate: cameras from photos of a board.
#pragma once

#include <pybind11/pybind11.h>

namespace hookeye {

void bind_calibration(pybind11::module_& m);

}  // namespace hookeye
