// Libraries that open threads of their own, within tasks that have the cores already.
#pragma once

#include <omp.h>

// Weak: another BLAS may stand in for OpenBLAS.
extern "C" void openblas_set_num_threads(int) __attribute__((weak));

namespace hookeye {

/// Makes OpenMP regions and OpenBLAS run on the calling thread while it lives.
class OneThread {
 public:
  OneThread() : levels_(omp_get_max_active_levels()) {
    omp_set_max_active_levels(0);
    if (openblas_set_num_threads) openblas_set_num_threads(1);
  }
  ~OneThread() { omp_set_max_active_levels(levels_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int levels_;
};

}  // namespace hookeye
