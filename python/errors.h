// C++ exceptions as those of hookeye.errors.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace hookeye {

/// Once, when the module is loaded.
void translate_errors();

/// Throws hookeye.InputError without a file: of an argument.
[[noreturn]] void bad_argument(const std::string& wrong, const std::string& right);

}  // namespace hookeye
