// The run folder, and its only writer. Each step is written whole (temporary folder, then rename)
// and never changed afterwards: a later verb adds files, and makes only its own anew.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/input_error.h"

namespace hookeye {

/// RUN/run.json, RUN/steps/NN-NAME/{model.yaml, metrics.json, diagnosis.json, parameters.csv, ...}
class Run {
 public:
  /// Creates the folder (parents too) and run.json, or opens it when it holds a run of the same
  /// capture. Throws InputError when it holds something else. One writer at a time: takes an
  /// advisory lock on RUN/.lock, throws InputError when another process has it. A run that has no
  /// step and no archive() when the object goes (the first fit failed) goes with it.
  static Run create(const std::filesystem::path& folder, const std::filesystem::path& capture);
  /// Opens an existing run; `write` takes the lock.
  static Run open(const std::filesystem::path& folder, bool write);
  Run(Run&&) noexcept;
  Run& operator=(Run&&) noexcept;
  ~Run();

  const std::filesystem::path& folder() const;
  std::filesystem::path capture() const;             ///< absolute path of the capture's yaml
  const nlohmann::json& timeline() const;            ///< the content of run.json (product contract)
  std::vector<std::filesystem::path> steps() const;  ///< folders of finished steps, in order
  std::filesystem::path archive() const;  ///< file of what was worked out so far (journal.h)

  /// All that write throw InputError with the folder's name where it was removed or moved since.
  /// `write` fills a temporary folder; it becomes steps/NN-NAME only when `write` returned, then
  /// `entry` is appended to run.json's "steps". Returns the step's folder.
  std::filesystem::path add_step(const std::string& name, nlohmann::json entry,
                                 const std::function<void(const std::filesystem::path&)>& write);
  /// A file added to a finished step by a later verb (diagnosis.json, compare's pictures): written
  /// to a temporary name and renamed; refuses to overwrite unless the bytes agree or `replace`.
  void add_file(const std::filesystem::path& step, const std::string& name,
                const std::function<void(const std::filesystem::path&)>& write,
                bool replace = false);
  /// A line behind those of RUN/NAME, which is no result: where it breaks off is for its reader.
  void append_line(const std::string& name, const std::string& line) const;
  /// Changes fields of run.json (verdict, floor, a step's diagnosis); written whole.
  void update(const std::function<void(nlohmann::json&)>& change);

 private:
  struct Impl;
  explicit Run(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace hookeye
