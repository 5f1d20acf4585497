#include "python/verbs.h"

#include <spdlog/spdlog.h>

#include "estimation/diagnosis/diagnosis_json.h"
#include "runs/add_step.h"
#include "runs/fit_base.h"
#include "runs/kept_work.h"
#include "runs/record.h"
#include "runs/run_limits.h"
#include "runs/search.h"
#include "runs/tables.h"

namespace hookeye {
namespace {

Bench bench_on(const std::shared_ptr<OpenedCapture>& capture) {
  const auto scene = capture->scene();
  return {capture->capture(), scene, Workspace(scene)};
}

void warn(const std::string& sentence) { spdlog::warn("{}", sentence); }

void warn_of_end(const Fitted& fitted) {
  const std::string said = not_converged(fitted.converged, fitted.iterations);
  if (!said.empty()) warn(said);
}

}  // namespace

std::shared_ptr<OpenedRun> fit_into(const PythonFit& wanted, const Listener& listener,
                                    const Work& work) {
  Bench bench = bench_on(wanted.capture);
  limits_for(wanted.out, wanted.capture->told());  // or its steps were made by others
  std::shared_ptr<Step> step;
  {
    Run run = create_run(wanted.out, wanted.capture->capture().file);
    keep_limits(run, *bench.scene->limits);
    const KeptWork kept(run, bench, nullptr);
    if (!run.steps().empty())
      throw InputError({wanted.out.string()}, "the base model of this run is fitted already",
                       "name a new folder, or open this one: hookeye.Run");
    BaseFit base;
    base.form = wanted.model ? wanted.model->form : base_form(bench.scene);
    base.start = wanted.model ? wanted.model->p : base.form.initial();
    base.additive = wanted.additive;
    base.command = wanted.command;
    FitOptions options = listener.fit();
    options.max_iterations = wanted.iterations;
    step = std::make_shared<Step>(
        fit_base(run, bench, base, options, [&](const Step&) { work.stop_if_cancelled(); }));
  }
  warn_of_end(step->fitted);
  return std::make_shared<OpenedRun>(wanted.out, wanted.capture, std::move(bench), std::move(step));
}

std::shared_ptr<OpenedRun> search_into(const PythonSearch& wanted, const Listener& listener,
                                       const Work& work) {
  for (const std::string& name : wanted.without) check_effect(name);
  Bench bench = bench_on(wanted.capture);
  limits_for(wanted.out, wanted.capture->told());
  std::shared_ptr<Step> last;
  {
    Run run = create_run(wanted.out, wanted.capture->capture().file);
    keep_limits(run, *bench.scene->limits);
    const KeptWork kept(run, bench, nullptr);
    SearchRequest request;
    request.options.fit = listener.fit();
    request.options.diagnosis = listener.diagnosis();
    request.options.diagnosis.without = wanted.without;
    request.command = wanted.command;
    request.warn = warn;
    request.step = [&](const Step& step) {
      listener.finished(step.name, step.fitted.evaluation.chi(false));
    };
    Discovery found = discover_into(run, bench, request, kept.from_before());
    if (found.verdict == Verdict::unexplained)
      tell_free_form(run, bench, found.steps.back(), work.cancelled());
    last = std::make_shared<Step>(std::move(found.steps.back()));
  }
  warn_of_end(last->fitted);
  return std::make_shared<OpenedRun>(wanted.out, wanted.capture, std::move(bench), std::move(last));
}

nlohmann::json diagnose_run(OpenedRun& opened, const Listener& listener, const Work& work) {
  FitOptions quiet = listener.fit();
  quiet.progress = nullptr;
  const std::shared_ptr<Step> newest = opened.newest(quiet);
  Step& step = *newest;
  Run run = open_run(opened.folder(), true);
  const KeptWork kept(run, opened.bench(), nullptr);
  diagnose_newest(run, opened.bench(), step, listener.diagnosis());
  nlohmann::json out = to_json(step.diagnosis);
  if (leaders(step.diagnosis).empty()) {
    const auto forces = tell_free_form(run, opened.bench(), step, work.cancelled());
    if (!forces.empty()) out["free_form"] = to_json(forces);
  }
  return out;
}

void add_to_run(OpenedRun& opened, const std::string& effect, bool take_back,
                const std::string& command, const Listener& listener) {
  check_effect(effect);
  const AddRequest request{effect, take_back};
  FitOptions quiet = listener.fit();
  quiet.progress = nullptr;
  Step current = *opened.newest(quiet);
  Run run = open_run(opened.folder(), true);
  check_stands(run, request);
  Bench& bench = opened.bench();
  const KeptWork kept(run, bench, nullptr);
  AddOptions options;
  options.fit = listener.fit();
  options.diagnosis = listener.diagnosis();
  options.doing = [](const std::string& work) { spdlog::info("{}", work); };
  options.note = options.doing;
  if (auto stored = stored_diagnosis(run, current.fitted))
    current.diagnosis = std::move(*stored);
  else if (!take_back)
    diagnose_newest(run, bench, current, options.diagnosis);
  Step step = next_step(bench, current, request, options);
  record(run, step, command);
  opened.forget();
  diagnose_newest(run, bench, step, options.diagnosis);
  record_all_pixels(run, bench, step, quiet);
  warn_of_end(step.fitted);
  listener.finished(step.name, step.fitted.evaluation.chi(false));
}

}  // namespace hookeye
