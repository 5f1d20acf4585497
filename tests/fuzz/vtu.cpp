#include "fuzz.h"
#include "meshing/detail.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return hookeye::fuzz::on_file("a.vtu", data, size,
                                [](const auto& file) { hookeye::detail::read_vtu(file); });
}
