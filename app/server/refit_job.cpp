#include "app/server/refit_job.h"

#include "app/commands/kept_work.h"
#include "app/interrupt.h"

namespace hookeye {

using nlohmann::json;

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
  started_ = stage_started_ = Clock::now();
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
  const auto now = Clock::now();
  out["seconds"] = std::chrono::duration<double>(now - started_).count();
  const int done = out.value("iteration", 0), of = out.value("of", 0);
  if (done > first_iteration_ && of > done)
    out["seconds_left"] = std::chrono::duration<double>(now - stage_started_).count() /
                          (done - first_iteration_) * (of - done);
  return out;
}

void RefitJob::stage(const std::string& name) {
  const std::lock_guard lock(mutex_);
  begin_stage(name);
}

void RefitJob::begin_stage(const std::string& name) {
  state_["stage"] = name;
  state_["iteration"] = state_["of"] = first_iteration_ = 0;
  stage_started_ = Clock::now();
}

void RefitJob::told(const FitProgress& progress) {
  const std::lock_guard lock(mutex_);
  const std::string name = progress.stage == "final" ? "computing the final pictures and intervals"
                                                     : "refitting, " + progress.stage;
  if (state_.value("stage", "") != name || progress.iteration < state_.value("iteration", 0)) {
    begin_stage(name);
    first_iteration_ = progress.iteration;
  }
  state_["iteration"] = progress.iteration;
  state_["of"] = progress.of;
  if (progress.chi > 0.0) state_["chi"] = progress.chi;
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
  out.doing = [this](const std::string& work) { stage(work); };
  return out;
}

void RefitJob::refit(const AddRequest& request) {
  Run run = open_run(run_, true);
  if (!bench_) bench_.emplace(open_capture(run.capture(), session_));
  const KeptWork kept(run, *bench_);
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
  finish("done",
         fmt::format("χ {:.4g} → {:.4g} on the fitted photos", current.fitted.evaluation.chi(false),
                     step.fitted.evaluation.chi(false)));
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
