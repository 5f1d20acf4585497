// A folder of files that nobody keeps.
#pragma once

#include <filesystem>
#include <string>

namespace hookeye {

/// Made in TMPDIR, gone with the object. Throws InputError where none can be made.
class ScratchFolder {
 public:
  explicit ScratchFolder(const std::string& what);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace hookeye
