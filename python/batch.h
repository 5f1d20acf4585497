// hookeye.batch: one verb over many captures.
#pragma once

#include <pybind11/pybind11.h>

namespace hookeye {

void bind_batch(pybind11::module_& m);

}  // namespace hookeye
