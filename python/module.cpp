// The extension module hookeye._hookeye; the package hookeye/ gives it its face.
#include <pybind11/pybind11.h>
#include <tbb/global_control.h>

#include <memory>
#include <string>

#include "python/batch.h"
#include "python/calibration.h"
#include "python/capture.h"
#include "python/effect.h"
#include "python/equilibrium.h"
#include "python/errors.h"
#include "python/files.h"
#include "python/log.h"
#include "python/model.h"
#include "python/runs.h"
#include "python/sensor.h"

namespace hookeye {
namespace {

/// Cores to use; 0: all.
void set_threads(int count) {
  static std::unique_ptr<tbb::global_control> limit;
  limit.reset();
  if (count < 0) bad_argument("threads: " + std::to_string(count), "a number from 1, or 0 for all");
  if (count > 0)
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                  static_cast<size_t>(count));
}

}  // namespace
}  // namespace hookeye

PYBIND11_MODULE(_hookeye, m) {
  using namespace hookeye;
  keep_log();
  translate_errors();
  bind_capture(m);
  bind_model(m);
  bind_equilibrium(m);
  bind_runs(m);
  bind_files(m);
  bind_calibration(m);
  bind_batch(m);
  bind_effects(m);
  bind_sensors(m);
  m.def("set_threads", &set_threads, pybind11::arg("count"));
  m.attr("__version__") = HOOKEYE_VERSION;
}
