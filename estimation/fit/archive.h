// What was worked out once and need not be again: ends of fits, steps of trials, diagnoses.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/journal.h"

namespace hookeye {

class SharedWork;

/// What was asked. Two questions are the same where kind and text are and the numbers agree to
/// 1e-6: a model that is evaluated again from elsewhere differs in rounding.
struct Question {
  std::string kind;  ///< "fit", "state", "trial", ...
  std::string text;  ///< the model's form, and all that is no number
  std::vector<double> numbers;
  std::string from = {};  ///< mark of the equilibria that it is asked from (Workspace::Place)
};

/// Answers to questions about one capture, asked of one program. Not thread-safe.
///
/// Where several processes answer them, some are answered before it is their turn. Then the answer
/// must not depend on who was faster: of what this process has asked or worked out itself, in its
/// own order, 1e-6 is enough; what others answered counts in every bit of the question, and of
/// where it is asked from.
class Archive {
 public:
  /// `journal`: has what earlier processes worked out, and takes what comes. Null: in memory alone.
  explicit Archive(std::unique_ptr<Journal> journal = nullptr);
  ~Archive();

  /// From now on others answer, too. `collect`: what they answer goes into the journal when it is
  /// asked for.
  void share(std::shared_ptr<SharedWork> others, bool collect);

  /// False: it was not asked before. Where others are at work it is this process' turn then, until
  /// keep() or leave(); where one of them is at this question, its answer is waited for, unless
  /// `cancel` is set.
  bool find(const Question& question, nlohmann::json& answer,
            const std::atomic<bool>* cancel = nullptr);
  void keep(const Question& question, const nlohmann::json& answer);
  /// It has no answer that could be kept.
  void leave(const Question& question);
  bool empty() const;

  /// Others are at work, and what comes next is not ahead of its turn already.
  bool may_go_ahead() const;
  /// While it stands, what is asked and worked out is so for whoever comes to it later.
  class Ahead {
   public:
    explicit Ahead(Archive& archive);
    ~Ahead();
    Ahead(const Ahead&) = delete;
    Ahead& operator=(const Ahead&) = delete;

   private:
    Archive& archive_;
    size_t asked_;
  };
  SharedWork* others() const;
  /// The same for the same question in every bit.
  static std::string key_of(const Question& question);

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
