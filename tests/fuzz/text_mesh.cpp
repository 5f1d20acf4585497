#include "fuzz.h"
#include "meshing/detail.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return hookeye::fuzz::on_file("a.mesh", data, size,
                                [](const auto& file) { hookeye::detail::read_text_mesh(file); });
}
