// hookeye.Run: a run folder, and the verbs that write one.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "python/model.h"
#include "python/work.h"
#include "runs/bench.h"

namespace hookeye {

/// The newest step of a run with its pictures and derivatives, once something needs them.
class OpenedRun {
 public:
  explicit OpenedRun(std::filesystem::path folder);
  OpenedRun(std::filesystem::path folder, std::shared_ptr<OpenedCapture> capture, Bench bench,
            std::shared_ptr<Step> newest);

  const std::filesystem::path& folder() const { return folder_; }
  /// Held by whoever works with what follows.
  std::mutex working;
  /// The run's own, by the options that it keeps.
  const std::shared_ptr<OpenedCapture>& capture();
  Bench& bench();
  /// Evaluated again where another hand has added a step. Throws InputError where there is none.
  std::shared_ptr<Step> newest(const FitOptions& options);
  void forget() { newest_.reset(); }

 private:
  std::filesystem::path folder_;
  std::shared_ptr<OpenedCapture> capture_;
  std::optional<Bench> bench_;
  std::shared_ptr<Step> newest_;
  size_t steps_ = 0;  ///< of the run, as `newest_` was its last
};

/// Told the work's progress: {work, stage, done, of, chi}. Callable from any thread of the work.
class Listener {
 public:
  Listener(Work& work, pybind11::object on_step) : work_(work), on_step_(std::move(on_step)) {}
  FitOptions fit() const;
  DiagnosisOptions diagnosis() const;
  void finished(const std::string& step, double chi) const;

 private:
  void tell(const std::string& work, const std::string& stage, int done, int of, double chi) const;
  Work& work_;
  pybind11::object on_step_;
};

void bind_runs(pybind11::module_& m);

}  // namespace hookeye
