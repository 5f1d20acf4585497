// Measured fields as arrays (hookeye/measured_field.py).
#pragma once

#include <pybind11/pybind11.h>

#include "estimation/evaluation/evaluation.h"

namespace hookeye {

/// All fields of a capture but those of `use: test`: a dict each.
pybind11::list fields_told(const Capture& capture);
/// Those of an evaluation, with what is predicted.
pybind11::list fields_seen(const Capture& capture, const Evaluation& evaluation);

}  // namespace hookeye
