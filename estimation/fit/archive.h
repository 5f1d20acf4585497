// What was worked out once and need not be again: ends of fits, steps of trials, diagnoses.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/journal.h"

namespace hookeye {

/// What was asked. Two questions are the same where kind and text are and the numbers agree to
/// 1e-6: a model that is evaluated again from elsewhere differs in rounding.
struct Question {
  std::string kind;  ///< "fit", "state", "trial", ...
  std::string text;  ///< the model's form, and all that is no number
  std::vector<double> numbers;
};

/// Answers to questions about one capture, asked of one program. Not thread-safe.
class Archive {
 public:
  /// `journal`: has what earlier processes worked out, and takes what comes. Null: in memory alone.
  explicit Archive(std::unique_ptr<Journal> journal = nullptr);
  ~Archive();

  /// False: it was not asked before.
  bool find(const Question& question, nlohmann::json& answer);
  void keep(const Question& question, const nlohmann::json& answer);
  bool empty() const;

  struct Tally {
    int found = 0, kept = 0;
  };
  const std::map<std::string, Tally>& tallies() const;  ///< by kind, of this process
  enum class Event { known, anew, kept };  ///< found; to be worked out; worked out and written
  std::function<void(const Question&, Event)> on_event;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hookeye
