#include "app/scratch_folder.h"

#include <unistd.h>

#include <cstdlib>

#include "core/input_error.h"

namespace hookeye {

namespace fs = std::filesystem;

ScratchFolder::ScratchFolder(const std::string& what) {
  std::error_code failed;
  const fs::path place = fs::temp_directory_path(failed);
  std::string name = (place / ("hookeye-" + what + "-XXXXXX")).string();
  if (failed || ::mkdtemp(name.data()) == nullptr)
    throw InputError({place.string()}, "no folder can be made here",
                     "TMPDIR set to a folder that is open to you");
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace hookeye
