#include "runs/report/inside.h"

#include <algorithm>

namespace hookeye {

namespace fs = std::filesystem;

bool inside(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  const fs::path real = fs::canonical(file, error);
  const fs::path within = error ? fs::path() : fs::canonical(folder, error);
  if (error) return false;
  // Part by part, so that RUN2 does not lie in RUN.
  return std::mismatch(within.begin(), within.end(), real.begin(), real.end()).first ==
         within.end();
}

fs::path link_out_of(const fs::path& folder) {
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error))
    if (it->is_symlink() && !inside(folder, it->path())) return it->path();
  return {};
}

}  // namespace hookeye
