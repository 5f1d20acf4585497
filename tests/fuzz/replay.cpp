// Files through the program's own readers, helpers and all: replay KIND FILE...
// Whatever a library does with a file, it is read or refused, within 10 seconds and without 1 GB.
#include <sys/resource.h>

#include <chrono>
#include <iterator>

#include "capture_io/camera.h"
#include "capture_io/image.h"
#include "fuzz.h"
#include "meshing/surface_mesh.h"
#include "meshing/tet_mesh.h"

namespace hookeye::fuzz {
namespace {

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// As the targets lay it out: some take their kind from the first byte.
void replay(const std::string& target, const std::string& bytes) {
  const auto first = static_cast<unsigned char>(bytes.empty() ? 0 : bytes[0]);
  const std::string rest = bytes.empty() ? "" : bytes.substr(1);
  const auto on = [](const std::string& name, const std::string& content, const auto& read) {
    on_file(name, reinterpret_cast<const uint8_t*>(content.data()), content.size(), read);
  };
  const auto volume = [](const auto& file) { read_volume(file, {}); };
  if (target == "helper_gmsh" && first % 2) return on("a.msh", "$MeshFormat\n" + rest, volume);
  if (target == "helper_gmsh") return on("a.mesh", "MeshVersionFormatted " + rest, volume);
  if (target == "helper_pictures")
    return on("a.png", bytes, [](const auto& file) { read_image(file); });
  on("a.yml", bytes, [](const auto& file) { read_opencv_calibration(file); });
}

int replay_all(const std::string& target, int count, char** files) {
  using Clock = std::chrono::steady_clock;
  int slow = 0;
  for (int i = 0; i < count; ++i) {
    std::printf("%s\n", files[i]);
    std::fflush(stdout);  // the last one named is the one that fails
    const auto begin = Clock::now();
    replay(target, bytes_of(files[i]));
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    if (seconds > 10.0) std::printf("  takes %.1f s\n", seconds), ++slow;
  }
  rusage own{}, helpers{};
  getrusage(RUSAGE_SELF, &own);
  getrusage(RUSAGE_CHILDREN, &helpers);
  const long most = std::max(own.ru_maxrss, helpers.ru_maxrss) / 1024;
  std::printf("%d files of %s read or refused, at most %ld MB in a process\n", count,
              target.c_str(), most);
  return slow > 0 || most > 1000 ? 1 : 0;
}

}  // namespace
}  // namespace hookeye::fuzz

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  return hookeye::fuzz::replay_all(argv[1], argc - 2, argv + 2);
}
