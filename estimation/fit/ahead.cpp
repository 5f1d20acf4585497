#include "estimation/fit/ahead.h"

#include <utility>

#include "estimation/fit/archived.h"
#include "estimation/fit/shared_work.h"

namespace hookeye {

namespace {

/// A task that is taken: whatever ends it, it is done, or somebody else's.
class Taken {
 public:
  Taken(SharedWork& others, std::string key, const std::atomic<bool>* cancel)
      : others_(others), key_(std::move(key)), cancel_(cancel) {}
  Taken(const Taken&) = delete;
  Taken& operator=(const Taken&) = delete;
  ~Taken() { others_.finish(key_, done_ && !(cancel_ && *cancel_)); }
  void done() { done_ = true; }

 private:
  SharedWork& others_;
  std::string key_;
  const std::atomic<bool>* cancel_;
  bool done_ = false;
};

}  // namespace

AheadTask ahead_task(const std::string& what, const ModelForm& form, const VectorXd& p,
                     std::function<void()> work) {
  return {question_of("ahead: " + what, form, p), std::move(work)};
}

void work_ahead(Workspace& workspace, const std::atomic<bool>* cancel,
                const std::vector<AheadTask>& tasks, bool leading) {
  Archive* archive = workspace.archive();
  if (!archive || tasks.size() < 2 || !archive->may_go_ahead()) return;
  SharedWork& others = *archive->others();
  const Workspace::Place here = workspace.place();
  const auto key_of = [&](const AheadTask& task) {
    Question about = task.about;
    about.from = mark_of(here);
    return kTaskMark + Archive::key_of(about);
  };
  for (const AheadTask& task : tasks) {
    if ((cancel && *cancel) || (leading && others.answered(key_of(tasks.front())))) break;
    const std::string key = key_of(task);
    if (!others.claim(key)) continue;
    Taken taken(others, key, cancel);
    const Archive::Ahead ahead(*archive);
    workspace.start_from(here);
    task.work();
    taken.done();
  }
  workspace.start_from(here);
}

FitOptions untold(FitOptions options) {
  options.decided = nullptr;
  options.progress = nullptr;
  return options;
}

}  // namespace hookeye
