#include "simulation/blas.h"

#include <dlfcn.h>

#include <filesystem>
#include <string>

// Weak: another BLAS has no such functions.
extern "C" char* openblas_get_config() __attribute__((weak));
extern "C" char* openblas_get_corename() __attribute__((weak));

namespace hookeye {

LoadedBlas loaded_blas() {
  LoadedBlas out;
  Dl_info found{};
  void* product = ::dlsym(RTLD_DEFAULT, "dgemm_");
  if (product != nullptr && ::dladdr(product, &found) != 0 && found.dli_fname != nullptr) {
    std::error_code failed;
    const auto file = std::filesystem::canonical(found.dli_fname, failed);
    out.file = failed ? std::string(found.dli_fname) : file.string();
  }
  if (openblas_get_config) {  // "OpenBLAS 0.3.21 NO_LAPACKE DYNAMIC_ARCH ..."
    const std::string told = openblas_get_config();
    const size_t name = told.find(' ');
    out.version = told.substr(0, name == std::string::npos ? name : told.find(' ', name + 1));
  }
  if (openblas_get_corename) out.kernels = openblas_get_corename();
  return out;
}

}  // namespace hookeye
