#include "app/commands/solve.h"

#include <tbb/parallel_for.h>

#include "app/interrupt.h"
#include "app/progress.h"
#include "app/session.h"
#include "core/memory_left.h"
#include "core/scope.h"
#include "estimation/effects/catalogue.h"
#include "runs/failed.h"

namespace hookeye {

Model realise_model(const std::string& file, const std::shared_ptr<const Scene>& scene) {
  if (!file.empty()) {
    const auto [form, p] = read_model(file, scene, catalogue());
    return form.realise(p);
  }
  const ModelForm form = base_form(scene);
  return form.realise(form.initial());
}

std::vector<Result<void>> solve_examples(const Model& model, const std::string& title,
                                         const std::function<void(int, const Equilibrium&)>& done) {
  const auto& examples = model.scene->capture.examples;
  std::vector<Result<void>> failures(examples.size());
  EquilibriumOptions options;
  options.cancelled = [] { return interrupted().load(); };
  Progress progress(title, static_cast<int>(examples.size()));
  const auto solve = [&](size_t i) {
    const Scope scope("example " + examples[i].name);
    const int e = static_cast<int>(i);
    EquilibriumSolver solver(model.scene->mesh());
    const auto solved = solver.solve(model.energy_of(e), model.examples[i].loading, options);
    failures[i] = {};
    if (!solved) {
      failures[i] = failure_of(solved);
      failures[i].error().example = examples[i].name;
    } else {
      done(e, *solved);
    }
  };
  tbb::parallel_for(size_t{0}, examples.size(), [&](size_t i) {
    solve(i);
    progress.advance("example " + examples[i].name);
  });
  // What found no room beside others may find it alone.
  for (size_t i = 0; i < examples.size() && examples.size() > 1; ++i)
    if (!failures[i] && out_of_memory(failures[i].error())) solve(i);
  return failures;
}

void fail_on_first(std::vector<Result<void>>& failures) {
  for (auto& failure : failures)
    if (!failure) fail(std::move(failure.error()));
}

}  // namespace hookeye
