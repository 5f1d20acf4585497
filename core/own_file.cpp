#include "core/own_file.h"

#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace hookeye {

// dladdr() tells a program by the name that it was started with.
std::filesystem::path own_file() {
  const auto here = reinterpret_cast<std::uintptr_t>(&own_file);
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    std::istringstream fields(line);
    std::uintptr_t begin = 0, end = 0;
    char dash = 0;
    std::string access, offset, device, inode, file;
    fields >> std::hex >> begin >> dash >> end >> access >> offset >> device >> inode >> std::ws;
    if (here < begin || here >= end) continue;
    std::getline(fields, file);
    return file;
  }
  throw std::runtime_error("/proc/self/maps does not tell which file this program is");
}

}  // namespace hookeye
