// What was worked out once and need not be again: ends of fits, steps of trials, diagnoses.
#pragma once

#include <any>
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

class Crew;

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
  void sync() const;  ///< what was kept is there for other machines

  /// The others that work on the same search (crew.h): where the archive does not know, they may.
  void work_with(std::shared_ptr<Crew> crew);
  Crew* crew() const;
  /// Takes in what another's journal has more than at the last time. `copied`: into this one's own,
  /// else it is read there when it is asked for. Whether there was more.
  bool learn_from(const std::shared_ptr<Journal>& other, bool copied);

  /// While it lives, one task of several that are shared out is at work: the search asks the same
  /// once more later, and until then results stay as they are, without being read again.
  class Task {
   public:
    explicit Task(Archive& archive);
    ~Task();
    Task(const Task&) = delete;
    Task& operator=(const Task&) = delete;

   private:
    Archive& archive_;
  };
  bool in_task() const;
  void drop_results();

  /// While it lives, the question of a fit, a trial or a diagnosis is worked on; within it others
  /// may be asked.
  class Asking {
   public:
    explicit Asking(Archive* archive);
    ~Asking();
    Asking(const Asking&) = delete;
    Asking& operator=(const Asking&) = delete;
    /// A task's result, once. Empty: there is none.
    std::any result(const Question& question) const;
    /// A task asks: what it comes to is kept for the next result().
    bool keeps() const;
    void keep(const Question& question, std::any result) const;

   private:
    Archive* archive_;
  };

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
