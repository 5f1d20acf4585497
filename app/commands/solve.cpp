#include "app/commands/solve.h"

#include <tbb/parallel_for.h>

#include <numeric>

#include "app/interrupt.h"
#include "app/progress.h"
#include "app/session.h"
#include "core/memory_left.h"
#include "core/scope.h"
#include "estimation/effects/catalogue.h"
#include "estimation/evaluation/load_case_share.h"
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

namespace {

using Solved = std::function<void(int example, const Equilibrium& state)>;

/// Solves those examples.
void solve_some(const Model& model, const std::vector<size_t>& wanted, const std::string& title,
                const Solved& done, std::vector<Result<void>>& failures) {
  const auto& examples = model.scene->capture.examples;
  EquilibriumOptions options;
  options.cancelled = [] { return interrupted().load(); };
  Progress progress(title, static_cast<int>(wanted.size()));
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
  tbb::parallel_for(size_t{0}, wanted.size(), [&](size_t k) {
    solve(wanted[k]);
    progress.advance("example " + examples[wanted[k]].name);
  });
  // What found no room beside others may find it alone.
  for (const size_t i : wanted)
    if (wanted.size() > 1 && !failures[i] && out_of_memory(failures[i].error())) solve(i);
}

/// Each process solves its own, and all hear of all.
void solve_shared(LoadCaseShare& share, const Model& model, const std::string& title,
                  const Solved& done, std::vector<Result<void>>& failures) {
  const size_t count = failures.size();
  const std::vector<int> owner = dealt(std::vector<double>(count), share.processes());
  std::vector<LoadCaseShare::Result> results(count);
  std::vector<LoadCaseShare::Result*> all;
  std::vector<size_t> own;
  for (size_t i = 0; i < count; ++i) {
    all.push_back(&results[i]);
    if (owner[i] == share.self()) own.push_back(i);
  }
  const auto keep = [&](int e, const Equilibrium& state) {
    auto kept = std::make_shared<Equilibrium>();
    kept->q = state.q, kept->R = state.R;
    kept->newton_iterations = state.newton_iterations;
    kept->factorizations = state.factorizations;
    kept->stable = state.stable;
    results[static_cast<size_t>(e)].evaluation.equilibrium = std::move(kept);
  };
  solve_some(model, own, title, keep, failures);
  for (size_t i = 0; i < count; ++i) results[i].ended = failures[i];
  share.exchange(owner, std::move(all));
  for (size_t i = 0; i < count; ++i) {
    failures[i] = results[i].ended;
    if (failures[i]) done(static_cast<int>(i), *results[i].evaluation.equilibrium);
  }
}

}  // namespace

std::vector<Result<void>> solve_examples(const Model& model, const std::string& title,
                                         const Solved& done) {
  std::vector<Result<void>> failures(model.scene->capture.examples.size());
  if (LoadCaseShare* share = load_case_share(); share && share->processes() > 1) {
    solve_shared(*share, model, title, done, failures);
    return failures;
  }
  std::vector<size_t> all(failures.size());
  std::iota(all.begin(), all.end(), size_t{0});
  solve_some(model, all, title, done, failures);
  return failures;
}

void fail_on_first(std::vector<Result<void>>& failures) {
  for (auto& failure : failures)
    if (!failure) fail(std::move(failure.error()));
}

}  // namespace hookeye
