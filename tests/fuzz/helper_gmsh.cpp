// msh and medit, in the helper's own code: the first byte says which.
#define main helper_main
#include "meshing/helpers/gmsh.cpp"
#undef main
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace hookeye;
  if (size == 0) return 0;
  const std::string kind = data[0] % 2 ? "msh" : "mesh",
                    head = data[0] % 2 ? "$MeshFormat\n" : "MeshVersionFormatted ";
  std::string bytes = head;
  bytes.append(reinterpret_cast<const char*>(data) + 1, size - 1);
  return fuzz::on_file("a." + kind, reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(),
                       [&](const auto& file) {
                         Packer request;
                         request.put("volume").put(file.string());
                         detail::pack(request, Place{file.string()});
                         const std::string packed = request.take();
                         Unpacker from(packed);
                         detail::answer(from);
                       });
}
