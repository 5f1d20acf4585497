#include "render/instruction_set.h"

#include <fmt/format.h>
#include <hwy/highway.h>

#include <cstdlib>

#include "core/input_error.h"

namespace hookeye {

namespace {

struct Choice {
  const char* name;
  int64_t targets;  ///< of Highway, which are to be used at most
  int64_t needs;    ///< one of these tells that the processor has them; 0: all have
};

constexpr int64_t kPlain = HWY_SCALAR | HWY_EMU128;
constexpr int64_t kSse = kPlain | HWY_SSSE3 | HWY_SSE4;
constexpr int64_t kAvx512 = HWY_AVX3 | HWY_AVX3_DL;
constexpr Choice kChoices[] = {{"sse2", kPlain, 0},
                               {"avx", kSse, HWY_AVX2 | kAvx512},
                               {"avx2", kSse | HWY_AVX2, HWY_AVX2 | kAvx512},
                               {"avx512", kSse | HWY_AVX2 | kAvx512, kAvx512}};

}  // namespace

std::string limited_instruction_set() {
  const char* wanted = std::getenv("HOOKEYE_ISA");
  if (wanted == nullptr || *wanted == '\0') return "";
  const Place place{"environment variable HOOKEYE_ISA", 0, 0};
  for (const Choice& choice : kChoices) {
    if (choice.name != std::string(wanted)) continue;
    if (choice.needs != 0 && (hwy::SupportedTargets() & choice.needs) == 0)
      throw InputError(place, fmt::format("this processor has no {} instructions", wanted),
                       "a smaller set, or the variable unset");
    hwy::DisableTargets(~choice.targets);
    return fmt::format("isa={}", wanted);
  }
  throw InputError(place, fmt::format("there is no instruction set '{}'", wanted),
                   "sse2, avx, avx2 or avx512");
}

}  // namespace hookeye
