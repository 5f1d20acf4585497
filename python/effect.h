// hookeye.Effect: effects written in Python, in the catalogue beside the others.
#pragma once

#include <pybind11/pybind11.h>

namespace hookeye {

void bind_effects(pybind11::module_& m);

}  // namespace hookeye
