// Which BLAS the program computes with: the one that the loader found, whatever it was built with.
#pragma once

#include <string>

namespace hookeye {

struct LoadedBlas {
  std::string file;     ///< the library that holds dgemm, links followed; empty: not known
  std::string version;  ///< "OpenBLAS 0.3.21"; empty: another BLAS
  std::string kernels;  ///< the processor that OpenBLAS takes this one for: "Zen", "SkylakeX"
};

LoadedBlas loaded_blas();

}  // namespace hookeye
