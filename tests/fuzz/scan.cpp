// ply and stl: the first byte says which.
#include "fuzz.h"
#include "meshing/surface_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  return hookeye::fuzz::on_file(data[0] % 2 ? "a.stl" : "a.ply", data + 1, size - 1,
                                [](const auto& file) { hookeye::read_surface(file); });
}
