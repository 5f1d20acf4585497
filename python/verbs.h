// The commands on a run, for Python. Each does its work with the interpreter's lock released.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "python/runs.h"

namespace hookeye {

struct PythonFit {
  std::shared_ptr<OpenedCapture> capture;
  std::optional<ModelState> model;  ///< empty: the base model at its starting values
  std::filesystem::path out;
  std::optional<int> iterations;
  bool additive = false;
  std::string command;
};
/// Throws as fit_base(); nothing is written of a fit that did not end.
std::shared_ptr<OpenedRun> fit_into(const PythonFit& wanted, const Listener& listener,
                                    const Work& work);

struct PythonSearch {
  std::shared_ptr<OpenedCapture> capture;
  std::filesystem::path out;
  std::vector<std::string> without;
  std::string command;
};
/// Steps that are finished stay where it is stopped.
std::shared_ptr<OpenedRun> search_into(const PythonSearch& wanted, const Listener& listener,
                                       const Work& work);

/// The newest step's diagnosis, as `hookeye diagnose --json` prints it.
nlohmann::json diagnose_run(OpenedRun& run, const Listener& listener, const Work& work);

/// The next step.
void add_to_run(OpenedRun& run, const std::string& effect, bool take_back,
                const std::string& command, const Listener& listener);

}  // namespace hookeye
