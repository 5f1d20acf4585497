// Several processes that work on one search: all of them take its way, and what one has worked out
// the others find in their archives. What is independent is shared out; all else one works out.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "estimation/evaluation/evaluation.h"
#include "estimation/fit/archive.h"
#include "estimation/fit/fit.h"

namespace hookeye {

/// The others, as one of them sees them.
class Crew {
 public:
  virtual ~Crew() = default;

  /// Has every task done by somebody; `work(i)` does it here, for one after the other. `keys`: what
  /// all know them by. Returns when all are done, or cannot be waited for.
  virtual void share(const std::vector<std::string>& keys,
                     const std::function<void(size_t)>& work) = 0;
  /// The archive does not know what is asked, and it is no task. True: look again; false: it is to
  /// be worked out here. Throws where nothing comes any more.
  virtual bool wait() = 0;
};

/// A task of one kind ("refit gravity") on the model at p.
Question task_on(const std::string& kind, const ModelForm& form, const VectorXd& p);

/// What is asked ahead is told when it is asked for itself.
FitOptions untold(FitOptions options);

/// Independent questions, each asked from where the workspace is now. Alone, nothing is done ahead.
class SideBySide {
 public:
  explicit SideBySide(Workspace& workspace);
  ~SideBySide();
  SideBySide(const SideBySide&) = delete;
  SideBySide& operator=(const SideBySide&) = delete;
  /// Has the questions of all tasks asked and answered, by this process and others: `ask(i)` asks
  /// those of one. After it the archive knows them, whoever did. `tasks`: task_on().
  void ask_ahead(const std::vector<Question>& tasks, const std::function<void(size_t)>& ask) const;
  /// Before each task is asked for itself.
  void begin() const;

 private:
  Workspace& workspace_;
  Workspace::Place place_;
};

}  // namespace hookeye
