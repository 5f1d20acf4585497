// Which vector instructions rays and pixels use. Internal to render.
#pragma once

#include <string>

namespace hookeye {

/// Obeys the environment variable HOOKEYE_ISA: `sse2`, `avx`, `avx2` or `avx512` keep to that set,
/// though the processor has more; unset or empty: the best of this processor. It is for comparing
/// machines: the answer must not depend on it. Returns what Embree's device takes (`isa=avx2`, or
/// nothing). Throws InputError on another word, or where the processor has no such instructions.
std::string limited_instruction_set();

}  // namespace hookeye
