#include "fuzz.h"
#include "meshing/surface_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  return hookeye::fuzz::on_file("a.obj", data, size,
                                [](const auto& file) { hookeye::read_surface(file); });
}
