// hookeye.Capture and hookeye.Camera.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "capture_io/capture.h"
#include "estimation/model/model.h"
#include "runs/run_limits.h"

namespace hookeye {

/// A capture, and its scene once something needs body or photos.
class OpenedCapture {
 public:
  /// Throws InputError.
  OpenedCapture(const std::filesystem::path& path, std::vector<ToldLimit> told);

  const Capture& capture() const { return capture_; }
  const std::vector<ToldLimit>& told() const { return told_; }
  /// Without the examples that no fit may see. Read at the first call, which logs what is most
  /// likely not meant. Thread-safe.
  std::shared_ptr<const Scene> scene();

 private:
  Capture capture_;
  std::vector<ToldLimit> told_;
  Limits limits_;
  std::mutex mutex_;
  std::shared_ptr<const Scene> scene_;
};

void bind_capture(pybind11::module_& m);

}  // namespace hookeye
