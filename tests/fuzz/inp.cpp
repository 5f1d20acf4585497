#include "fuzz.h"
#include "meshing/tet_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return hookeye::fuzz::on_file("a.inp", data, size,
                                [](const auto& file) { hookeye::read_volume(file, {}); });
}
