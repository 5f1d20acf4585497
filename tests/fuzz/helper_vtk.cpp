// vtu, ply and stl, in the helper's own code: the first byte says which.
#define main helper_main
#include "meshing/helpers/vtk.cpp"
#undef main
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace hookeye;
  if (size == 0) return 0;
  const std::string kinds[] = {"volume", "ply", "stl"};
  const std::string kind = kinds[data[0] % 3];
  return fuzz::on_file("a." + kind, data + 1, size - 1, [&](const auto& file) {
    Packer request;
    request.put(kind).put(file.string());
    detail::pack(request, Place{file.string()});
    const std::string bytes = request.take();
    Unpacker from(bytes);
    answer(from);
  });
}
