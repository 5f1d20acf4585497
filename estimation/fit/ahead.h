// Candidates that do not hang on one another, shared out among the processes of one search.
#pragma once

#include <atomic>
#include <functional>
#include <vector>

#include "estimation/evaluation/evaluation.h"
#include "estimation/fit/archive.h"
#include "estimation/fit/fit.h"

namespace hookeye {

/// One of them.
struct AheadTask {
  Question about;              ///< another of each
  std::function<void()> work;  ///< asks what whoever comes to it will ask, and decides nothing
};

/// About the form at p: `what` is to be done with it.
AheadTask ahead_task(const std::string& what, const ModelForm& form, const VectorXd& p,
                     std::function<void()> work);

/// Stands before a loop over candidates. Where others work on the same search (Archive::share),
/// each takes of the tasks what nobody has taken, from the first on, and then goes through the loop
/// in its own order: all that was taken is answered there, or waited for. So what is decided on the
/// way is the same, whoever worked on what. Alone, nothing is done ahead.
/// `leading`: the first one settles which of the others are worth it; they are taken only until it
/// is done.
/// Each is begun from where the workspace stands, which is as before in the end: the loop has to
/// begin each of its fits there, too.
void work_ahead(Workspace& workspace, const std::atomic<bool>* cancel,
                const std::vector<AheadTask>& tasks, bool leading = false);

/// Of what is done ahead nobody is told.
FitOptions untold(FitOptions options);

}  // namespace hookeye
