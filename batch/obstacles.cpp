#include "batch/obstacles.h"

#include <sys/stat.h>
#include <sys/statvfs.h>

#include <cerrno>
#include <cstring>

namespace hookeye {
namespace {

constexpr double kLeastRoom = 32e6;  // [bytes]

}  // namespace

FileMark mark_of(const std::filesystem::path& file) {
  struct stat found {};
  if (::stat(file.c_str(), &found) != 0) return {};
  return {found.st_dev, found.st_ino, found.st_mtim.tv_sec, found.st_mtim.tv_nsec, found.st_size};
}

bool out_of_room(const std::filesystem::path& folder) {
  struct statvfs found {};
  if (::statvfs(folder.c_str(), &found) != 0) return false;
  return static_cast<double>(found.f_bavail) * static_cast<double>(found.f_frsize) < kLeastRoom;
}

bool tells_a_full_disk(const std::string& line) {
  return line.find(std::strerror(ENOSPC)) != std::string::npos ||
         line.find(std::strerror(EDQUOT)) != std::string::npos;
}

}  // namespace hookeye
