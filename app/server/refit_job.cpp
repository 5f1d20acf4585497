#include "app/server/refit_job.h"

#include <algorithm>
#include <iterator>

#include "app/interrupt.h"
#include "runs/kept_work.h"
#include "runs/run_limits.h"

namespace hookeye {

using nlohmann::json;

namespace {

/// Where a stage ends, of the whole: a rough guess, not measured. The time left follows from it.
struct StageEnd {
  std::string_view begins;
  double share;
};
constexpr StageEnd kStages[] = {
    {"reading", 0.05},   {"evaluating", 0.15}, {"diagnosing the newest", 0.35}, {"refitting", 0.65},
    {"computing", 0.72}, {"writing", 0.78},    {"diagnosing the new step", 1.0}};
/// Of a refit, what is done before it comes to full size.
constexpr double kCoarse = 0.4;

}  // namespace

RefitJob::~RefitJob() {
  stop();
  if (thread_.joinable()) thread_.join();
}

bool RefitJob::start(const AddRequest& request) {
  const std::lock_guard lock(mutex_);
  if (running_) return false;
  if (thread_.joinable()) thread_.join();
  running_ = true;
  cancel_ = false;
  started_ = Clock::now();
  share_ = from_ = 0.0;
  to_ = kStages[0].share;
  state_ = {{"state", "running"},
            {"effect", request.effect},
            {"take_back", request.take_back},
            {"stage", "reading the run"}};
  thread_ = std::thread([this, request] { work(request); });
  return true;
}

json RefitJob::state() {
  const std::lock_guard lock(mutex_);
  json out = state_;
  if (!running_) return out;
  if (cancel_) out["state"] = "stopping";
  const double seconds = std::chrono::duration<double>(Clock::now() - started_).count();
  out["seconds"] = seconds;
  out["share"] = share_;
  constexpr double kTold = 0.1;  // before that its pace says nothing
  if (share_ > kTold) out["seconds_left"] = seconds * (1.0 - share_) / share_;
  return out;
}

void RefitJob::stage(const std::string& name) {
  const std::lock_guard lock(mutex_);
  begin_stage(name);
}

void RefitJob::begin_stage(const std::string& name) {
  state_["stage"] = name;
  state_["iteration"] = state_["of"] = 0;
  const auto* own = std::find_if(std::begin(kStages), std::end(kStages),
                                 [&](const StageEnd& one) { return name.starts_with(one.begins); });
  if (own == std::end(kStages)) return;
  from_ = own == std::begin(kStages) ? 0.0 : std::prev(own)->share;
  to_ = own->share;
  reach(from_);
}

void RefitJob::reach(double share) { share_ = std::max(share_, share); }

void RefitJob::told(const FitProgress& progress) {
  const std::lock_guard lock(mutex_);
  const std::string name = progress.stage == "final" ? "computing the final pictures and intervals"
                                                     : "refitting, " + progress.stage;
  if (state_.value("stage", "") != name || progress.iteration < state_.value("iteration", 0))
    begin_stage(name);
  state_["iteration"] = progress.iteration;
  state_["of"] = progress.of;
  if (progress.chi > 0.0) state_["chi"] = progress.chi;
  const double within =
      progress.of > 0 ? std::min(1.0, double(progress.iteration) / progress.of) : 0.0;
  const bool full = progress.stage == "full size";
  reach(from_ + (to_ - from_) * (full ? kCoarse + (1.0 - kCoarse) * within : kCoarse * within));
}

void RefitJob::told_diagnosis(int done, int of) {
  const std::lock_guard lock(mutex_);
  if (of > 0) reach(from_ + (to_ - from_) * done / of);
}

void RefitJob::finish(const std::string& state, const std::string& message) {
  const std::lock_guard lock(mutex_);
  running_ = false;
  state_["state"] = state;
  state_["message"] = message;
}

AddOptions RefitJob::options() {
  AddOptions out;
  out.fit.cancel = out.diagnosis.cancel = &cancel_;
  out.fit.progress = [this](const FitProgress& progress) { told(progress); };
  out.diagnosis.progress = [this](int done, int of) { told_diagnosis(done, of); };
  out.doing = [this](const std::string& work) { stage(work); };
  return out;
}

void RefitJob::refit(const AddRequest& request) {
  Run run = open_run(run_, true);
  if (!bench_) bench_.emplace(open_capture(run.capture(), session_, limits_of(run.timeline())));
  const KeptWork kept(run, *bench_, &interrupted());
  AddOptions wanted = options();
  stage("evaluating the newest step");
  FitOptions quiet = wanted.fit;
  quiet.progress = nullptr;  // no fit yet: its "final" would be taken for the end
  Step current = newest_step(run, *bench_, quiet);
  if (auto stored = stored_diagnosis(run, current.fitted)) {
    current.diagnosis = std::move(*stored);
  } else if (!request.take_back) {
    stage("diagnosing the newest step");
    diagnose_newest(run, *bench_, current, wanted.diagnosis);
  }
  Step step = next_step(*bench_, current, request, wanted);
  stage("writing the step");
  record(run, step,
         fmt::format("hookeye add {} {}{}", shell_word(run_.string()), request.effect,
                     request.take_back ? " --take-back" : ""));
  stage("diagnosing the new step");
  diagnose_newest(run, *bench_, step, wanted.diagnosis);
  record_all_pixels(run, *bench_, step, quiet);
  finish("done",
         fmt::format("Normalised residual {:.4g} → {:.4g} on the fitted photos.",
                     current.fitted.evaluation.chi(false), step.fitted.evaluation.chi(false)));
}

void RefitJob::work(const AddRequest& request) {
  try {
    refit(request);
  } catch (const InputError& error) {
    finish("failed", error.what());
  } catch (const Interrupted&) {
    finish("stopped", "");
  } catch (const Failed& failed) {
    if (cancel_)
      finish("stopped", "");
    else
      finish("failed", fmt::format("{} {} (reached {:.3g} of the load)", failed.failure.example,
                                   failed.failure.reason, failed.failure.load_fraction));
  } catch (const std::exception& error) {
    finish("failed", error.what());
  }
}

}  // namespace hookeye
