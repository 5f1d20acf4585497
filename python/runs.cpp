#include "python/runs.h"

#include "runs/run_limits.h"

namespace hookeye {

namespace py = pybind11;

OpenedRun::OpenedRun(std::filesystem::path folder) : folder_(std::move(folder)) {
  open_run(folder_, false);  // it is one
}

OpenedRun::OpenedRun(std::filesystem::path folder, std::shared_ptr<OpenedCapture> capture,
                     Bench bench, std::shared_ptr<Step> newest)
    : folder_(std::move(folder)),
      capture_(std::move(capture)),
      bench_(std::move(bench)),
      newest_(std::move(newest)) {
  if (newest_) steps_ = open_run(folder_, false).steps().size();
}

const std::shared_ptr<OpenedCapture>& OpenedRun::capture() {
  if (!capture_) {
    const Run run = open_run(folder_, false);
    std::vector<ToldLimit> told;
    for (const auto& [name, value] : changed(limits_of(run.timeline())))
      told.push_back({name, value, "options of run.json"});
    capture_ = std::make_shared<OpenedCapture>(run.capture(), std::move(told));
  }
  return capture_;
}

Bench& OpenedRun::bench() {
  if (!bench_) {
    const auto scene = capture()->scene();
    bench_.emplace(Bench{capture_->capture(), scene, Workspace(scene)});
  }
  return *bench_;
}

std::shared_ptr<Step> OpenedRun::newest(const FitOptions& options) {
  const Run run = open_run(folder_, false);
  if (!newest_ || steps_ != run.steps().size()) {
    newest_ = std::make_shared<Step>(newest_step(run, bench(), options));
    steps_ = run.steps().size();
  }
  return newest_;
}

FitOptions Listener::fit() const {
  FitOptions options;
  options.cancel = work_.cancelled();
  if (!on_step_.is_none())
    options.progress = [this](const FitProgress& now) {
      tell("fit", now.stage, now.iteration, now.of, now.chi);
    };
  return options;
}

DiagnosisOptions Listener::diagnosis() const {
  DiagnosisOptions options;
  options.cancel = work_.cancelled();
  if (!on_step_.is_none())
    options.progress = [this](int done, int of) { tell("diagnose", "", done, of, 0.0); };
  return options;
}

void Listener::finished(const std::string& step, double chi) const {
  if (!on_step_.is_none()) tell("step", step, 1, 1, chi);
}

void Listener::tell(const std::string& work, const std::string& stage, int done, int of,
                    double chi) const {
  work_.tell([&] { on_step_(work, stage, done, of, chi); });
}

}  // namespace hookeye
