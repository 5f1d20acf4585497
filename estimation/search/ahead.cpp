#include "estimation/search/ahead.h"

#include "estimation/search/refit.h"

namespace hookeye {

void refit_ahead(Workspace& workspace, const SideBySide& alike,
                 const std::vector<const Racer*>& racers, const FitOptions& options) {
  std::vector<Question> tasks;
  for (const Racer* one : racers)
    tasks.push_back(task_on("refit with " + one->effect, one->form, one->trial.p));
  alike.ask_ahead(tasks, [&](size_t i) { refit(workspace, *racers[i], untold(options)); });
}

void add_ahead(Workspace& workspace, const SideBySide& alike, const Fitted& current,
               const std::vector<const EffectScore*>& effects, const FitOptions& options) {
  std::vector<Question> tasks;
  for (const EffectScore* one : effects)
    tasks.push_back(task_on("adding " + one->effect, current.form, current.p));
  alike.ask_ahead(tasks,
                  [&](size_t i) { add_effect(workspace, current, *effects[i], untold(options)); });
}

}  // namespace hookeye
