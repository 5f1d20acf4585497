// Importers, the catalogue, and arrays written as the files that a capture names.
#pragma once

#include <pybind11/pybind11.h>

namespace hookeye {

void bind_files(pybind11::module_& m);

}  // namespace hookeye
