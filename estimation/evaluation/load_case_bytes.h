// What came of a load case, as bytes for a process of the same program on the same kind of machine.
#pragma once

#include <string>

#include "estimation/evaluation/load_case_share.h"

namespace hookeye {

std::string to_bytes(const LoadCaseShare::Result& result);
/// Throws std::runtime_error where they are not whole.
LoadCaseShare::Result from_bytes(const std::string& bytes);

}  // namespace hookeye
