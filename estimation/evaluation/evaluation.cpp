#include "estimation/evaluation/evaluation.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>

#include "estimation/evaluation/all_pixels.h"
#include "estimation/evaluation/columns.h"
#include "estimation/evaluation/field_evaluation.h"
#include "estimation/evaluation/load_case_share.h"
#include "estimation/evaluation/photo_evaluation.h"
#include "estimation/evaluation/sensor.h"
#include "estimation/evaluation/started_field.h"

namespace hookeye {

Camera camera_at_level(const Camera& camera, int level) {
  Camera coarse = camera.resized(std::pow(0.5, level));
  coarse.width >>= level;
  coarse.height >>= level;
  return coarse;
}

void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most that glibc takes
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

namespace {

/// The other way round: before something that takes more than all before it.
void give_back_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

bool among(const std::vector<int>& examples, int e) {
  return std::find(examples.begin(), examples.end(), e) != examples.end();
}

/// Where the equilibria of an evaluation with derivatives go with the parameters, to first order.
struct Linear {
  std::vector<std::shared_ptr<const Ingredient>> ingredients;
  VectorXd p;
  std::vector<VectorXd> q;         ///< by example; empty: was not solved
  std::vector<Eigen::MatrixXd> S;  ///< dq/dp

  /// Empty: not known.
  std::optional<VectorXd> at(const ModelForm& form, const VectorXd& there, int e) const {
    if (q.empty() || ingredients != form.ingredients || q[e].size() == 0) return {};
    return q[e] + S[e] * (there - p);
  }
};

}  // namespace

struct Workspace::Impl {
  std::shared_ptr<const Scene> scene;
  std::vector<EquilibriumSolver> solvers;  ///< one per example
  std::vector<VectorXd> last;  ///< by example: q of the last evaluation in which all had one
  Linear linear;               ///< of the last evaluation with derivatives, without candidates
  std::vector<PhotoComparer> comparers;  ///< one per example
  std::vector<FieldComparer> fields;     ///< one per example
  LoadCaseShare* share = load_case_share();
  std::vector<double> seconds;  ///< shared: by example, of its last evaluation
  std::vector<int> owner;       ///< shared: the process that works it out

  explicit Impl(std::shared_ptr<const Scene> s) : scene(std::move(s)) {
    for (size_t e = 0; e < scene->capture.examples.size(); ++e) {
      solvers.emplace_back(scene->mesh());
      last.emplace_back();
      comparers.emplace_back(scene, static_cast<int>(e));
      fields.emplace_back();
    }
    seconds.resize(scene->capture.examples.size());
    deal();
  }

  /// Asked where solvers start anew: till then an example stays with its process, as the factor
  /// that its solver keeps shows in the last digits.
  void deal() {
    if (!share) return;
    const std::vector<int> before = std::move(owner);
    owner = dealt_again(seconds, share->processes(), before);
    for (size_t e = 0; e < before.size(); ++e)
      if (before[e] == share->self() && owner[e] != before[e])
        comparers[e] = PhotoComparer(scene, static_cast<int>(e));  // its photos' memory
  }
  bool own(int e) const { return !share || owner[e] == share->self(); }

  /// What each process has worked out of `examples` reaches all.
  void exchange(const std::vector<int>& examples, std::vector<ExampleEvaluation>& solved,
                std::vector<Result<void>>& failures) {
    if (!share) return;
    std::vector<LoadCaseShare::Result> results;
    std::vector<LoadCaseShare::Result*> all;
    std::vector<int> owners;
    results.reserve(examples.size());
    for (int e : examples) {
      results.push_back({std::move(solved[e]), failures[e], seconds[e]});
      all.push_back(&results.back());
      owners.push_back(owner[e]);
    }
    share->exchange(owners, std::move(all));
    for (size_t i = 0; i < examples.size(); ++i) {
      const int e = examples[i];
      solved[e] = std::move(results[i].evaluation);
      failures[e] = std::move(results[i].ended);
      seconds[e] = results[i].seconds;
    }
  }

  /// Examples of which nothing was seen or measured are candidates of a plan: no equilibrium of
  /// theirs is asked for, and one that has none stops nothing.
  std::vector<int> wanted(const EvaluationOptions& options) const {
    std::vector<int> examples = options.only;
    if (!examples.empty()) return examples;
    for (size_t e = 0; e < scene->capture.examples.size(); ++e) {
      const ExampleSpec& example = scene->capture.examples[e];
      if (example.photos.empty() && example.measured.empty()) continue;
      if (example.validate ? options.held_out : options.fitted)
        examples.push_back(static_cast<int>(e));
    }
    return examples;
  }

  /// The example whose photos are the texture; -1: none.
  int reference() const {
    const BodySpec& body = scene->capture.body;
    return body.texture == BodySpec::Texture::rest ? scene->example_index(body.texture_example)
                                                   : -1;
  }

  /// Examples at whose equilibria others look: that of the texture, and those that fields start
  /// from.
  std::vector<int> references(const std::vector<int>& examples) const {
    std::vector<int> out = field_starts(*scene, examples);
    if (const int texture = reference(); texture >= 0 && !among(out, texture))
      out.push_back(texture);
    return out;
  }

  /// Equilibrium and sensitivities of one example. `expected`: where it may be; `cancelled` is
  /// polled.
  Result<void> solve(const Model& model, const ColumnSet* columns, int e,
                     const EvaluationOptions& options, const std::optional<VectorXd>& expected,
                     const std::function<bool()>& cancelled, ExampleEvaluation& out,
                     ExampleColumns& derivative) {
    EquilibriumOptions equilibrium_options;
    if (expected) equilibrium_options.expected = &*expected;
    equilibrium_options.factored = columns != nullptr;
    equilibrium_options.tolerance = options.tolerance;
    equilibrium_options.most_iterations = options.most_iterations;
    equilibrium_options.cancelled = cancelled;
    auto solved = solvers[e].solve(model.energy_of(e), model.examples[e].loading,
                                   equilibrium_options, last[e].size() ? &last[e] : nullptr);
    if (!solved) {
      solved.error().example = scene->capture.examples[e].name;
      return failure_of(solved);
    }
    auto equilibrium = std::make_shared<Equilibrium>(*std::move(solved));
    out.equilibrium = equilibrium;
    if (!columns) return {};
    derivative = columns->of_example(model, e, *equilibrium);
    out.S = sensitivities(*equilibrium, model.examples[e].loading, derivative.dR, derivative.dqc);
    equilibrium->factor.reset();  // the largest of all: models that are kept would keep it
    return {};
  }

  /// Where the next evaluation starts. Where one example has no equilibrium, the others may or may
  /// not have been solved already: all go back, so that the same fit takes the same way each time.
  void settle(const std::vector<int>& examples, const std::vector<ExampleEvaluation>& solved,
              bool failed) {
    for (int e : examples) {
      if (failed)
        solvers[e].forget();
      else
        last[e] = solved[e].equilibrium->q;
    }
  }

  void keep_linear(const ModelForm& form, const VectorXd& p,
                   const std::vector<ExampleEvaluation>& solved) {
    linear = {form.ingredients, p, {}, {}};
    for (const ExampleEvaluation& one : solved) {
      linear.q.push_back(one.S.size() ? one.equilibrium->q : VectorXd());
      linear.S.push_back(one.S);
    }
  }
};

namespace {

/// Predictions of what was measured with their derivatives.
std::vector<MeasuredEvaluation> compare_measured(const Scene& scene, const Model& model, int e,
                                                 const std::vector<ExampleEvaluation>& states,
                                                 const ExampleColumns* columns,
                                                 FieldComparer& fields) {
  std::vector<MeasuredEvaluation> all;
  const auto& specs = scene.capture.examples[e].measured;
  const Sensed seen{scene, model, e, *states[e].equilibrium, states[e].S, columns, &states};
  for (size_t i = 0; i < specs.size(); ++i) {
    if (specs[i].field) {
      all.push_back(fields.compare(static_cast<int>(i), seen));
      continue;
    }
    SensorPrediction there = predicted(specs[i], seen);
    MeasuredEvaluation one;
    one.example = e;
    one.index = static_cast<int>(i);
    one.r = specs[i].whitened(there.value - specs[i].value);
    one.predicted = std::move(there.value);
    if (columns) one.J = specs[i].whitened(std::move(there.J));
    all.push_back(std::move(one));
  }
  return all;
}

/// Adds what passes while it lives.
class Stopwatch {
 public:
  explicit Stopwatch(double& seconds) : seconds_(seconds) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() {
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// It has served its turn, and models that are kept would keep it: 16 MB of 10,000 nodes a load
/// case.
void drop_tangent(ExampleEvaluation& example) {
  if (!example.equilibrium) return;
  auto kept = std::make_shared<Equilibrium>();
  const Equilibrium& whole = *example.equilibrium;
  kept->q = whole.q;
  kept->R = whole.R;
  kept->W_ff = whole.W_ff;  // few values
  kept->newton_iterations = whole.newton_iterations;
  kept->factorizations = whole.factorizations;
  kept->stable = whole.stable;
  example.equilibrium = std::move(kept);
}

}  // namespace

Workspace::Workspace(std::shared_ptr<const Scene> scene)
    : impl_(std::make_unique<Impl>(std::move(scene))) {}
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
const Scene& Workspace::scene() const { return *impl_->scene; }
void Workspace::keep_in(std::shared_ptr<Archive> archive) { archive_ = std::move(archive); }
Archive* Workspace::archive() const { return archive_.get(); }

Workspace::Place Workspace::place() const { return {impl_->scene, impl_->last}; }

void Workspace::start_from(const Place& place) {
  if (place.scene != impl_->scene) impl_ = std::make_unique<Impl>(place.scene);
  for (EquilibriumSolver& solver : impl_->solvers) solver.forget();
  impl_->last = place.q;
  impl_->linear = {};
  impl_->deal();
}

Result<Evaluation> Workspace::evaluate(
    const ModelForm& form, const VectorXd& p, const EvaluationOptions& options,
    const std::vector<std::shared_ptr<const Ingredient>>& candidates) {
  if (form.scene != impl_->scene) impl_ = std::make_unique<Impl>(form.scene);
  const Model model = form.realise(p);
  std::optional<ColumnSet> columns;
  if (options.derivatives) columns.emplace(form, p, candidates);

  const Capture& capture = impl_->scene->capture;
  const int reference = impl_->reference();
  const std::vector<int> wanted = impl_->wanted(options);
  const size_t examples = capture.examples.size();
  std::vector<ExampleEvaluation> solved(examples);
  std::vector<ExampleColumns> derivative(examples);
  std::vector<Result<void>> failures(examples);
  const std::vector<int> references = impl_->references(wanted);
  std::vector<int> to_solve = wanted;
  for (int e : references)
    if (!among(wanted, e)) to_solve.push_back(e);
  std::vector<int> own = wanted, own_to_solve = to_solve;  // all look at the references
  std::erase_if(own, [&](int e) { return !impl_->own(e); });
  std::erase_if(own_to_solve, [&](int e) { return !impl_->own(e) && !among(references, e); });
  auto cancelled = [&] { return options.cancel && options.cancel->load(); };
  for (int e : to_solve) impl_->seconds[e] = 0.0;
  std::atomic<int> done = 0;
  std::atomic<bool> failed = false;
  const int all = static_cast<int>(own_to_solve.size() + own.size());
  auto advance = [&] {
    const int now = ++done;
    if (options.progress) options.progress(now, all);
  };
  // One example without an equilibrium is enough: nobody looks at the others.
  const std::function<bool()> pointless = [&] { return failed || cancelled(); };
  const auto solve = [&](int e) {
    if (pointless()) return;
    const Stopwatch watch(impl_->seconds[e]);
    failures[e] = impl_->solve(model, columns ? &*columns : nullptr, e, options,
                               impl_->linear.at(form, p, e), pointless, solved[e], derivative[e]);
    if (!candidates.empty()) impl_->solvers[e].forget();
    if (!failures[e] && hookeye::cancelled(failures[e].error())) failures[e] = {};
    if (!failures[e]) failed = true;
    advance();
  };
  // Candidates may have a finer mesh, whose factor is as large as all of these. A solver that
  // starts in equilibrium does without one, and to make them anew costs a hundredth of what
  // candidates do.
  if (!candidates.empty()) {
    for (EquilibriumSolver& solver : impl_->solvers) solver.forget();
    give_back_freed_memory();
  }
  const auto compare = [&](int e, const ReferenceState& reference_state) {
    if (pointless()) return;
    const Stopwatch watch(impl_->seconds[e]);
    solved[e].example = e;
    solved[e].held_out = capture.examples[e].validate;
    const ExampleColumns* d = columns ? &derivative[e] : nullptr;
    solved[e].photos = impl_->comparers[e].compare(model, solved[e], reference_state, d, options);
    solved[e].measured = compare_measured(*impl_->scene, model, e, solved, d, impl_->fields[e]);
    if (!among(references, e)) {  // at which others look
      derivative[e] = {};
      drop_tangent(solved[e]);
    }
    advance();
  };
  const auto for_each = [&](const std::vector<int>& examples, const auto& body) {
    const auto one = [&](size_t i) { body(examples[i]); };
    if (options.all_pixels)
      few_at_once(examples.size(), one);
    else
      tbb::parallel_for(size_t{0}, examples.size(), one);
  };
  // All look at the reference states. Without any every example goes on to its photos by itself,
  // and no core waits for the slowest equilibrium.
  if (references.empty()) {
    for_each(own, [&](int e) {
      solve(e);
      compare(e, {});
    });
  } else {
    for_each(own_to_solve, solve);
    ReferenceState state;
    if (reference >= 0)
      state = {reference, &solved[reference], columns ? &derivative[reference] : nullptr};
    for_each(own, [&](int e) { compare(e, state); });
  }
  if (cancelled()) return stopped();
  for (int e : references) drop_tangent(solved[e]);
  impl_->exchange(wanted, solved, failures);
  for (int e : wanted) failed = failed || !failures[e];
  impl_->settle(to_solve, solved, failed);
  for (int e : to_solve)
    if (!failures[e]) return failure_of(failures[e]);
  if (columns && candidates.empty()) impl_->keep_linear(form, p, solved);
  Evaluation out;
  out.columns = columns ? columns->size() : 0;
  out.measured_weight = options.measured_weight;
  for (int e : wanted) out.examples.push_back(std::move(solved[e]));
  return out;
}

}  // namespace hookeye
