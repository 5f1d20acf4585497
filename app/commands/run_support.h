// What the commands on a run share: opening it, its newest model, writing a step.
#pragma once

#include <optional>

#include "app/commands/tables.h"
#include "app/invocation.h"
#include "app/session.h"
#include "capture_io/run.h"
#include "estimation/search/discover.h"

namespace hookeye {

/// A capture opened for estimation. The scene is as told; the workspace follows the model, which
/// may live on a finer mesh.
struct Bench {
  Capture capture;                     ///< with the examples that no fit may see (use: test)
  std::shared_ptr<const Scene> scene;  ///< without them
  Workspace workspace;
};
/// What reading mended, and what is most likely not meant.
void warn_of_doubts(const Scene& scene, Session& session);

/// `limits`: what a run keeps of them, or the standard.
Bench open_capture(const std::filesystem::path& capture, Session& session,
                   const Limits& limits = {});

/// Run::open() and Run::create(), and the timeline holds what the commands read in it.
Run open_run(const std::filesystem::path& folder, bool write);
Run create_run(const std::filesystem::path& folder, const std::filesystem::path& capture);

/// Throws Interrupted or Failed where there is a failure instead of a value.
template <class T>
T value_or_fail(std::variant<T, NumericalFailure> result) {
  if (auto* failure = std::get_if<NumericalFailure>(&result)) fail(std::move(*failure));
  return std::get<T>(std::move(result));
}

/// Options with the progress bar and Ctrl-C wired in.
FitOptions fit_options();
DiagnosisOptions diagnosis_options();
/// What is to be said of a fit that stopped before its end; empty: it did not.
std::string not_converged(bool converged, int iterations);
/// A step of a run, its model evaluated again (pictures and derivatives).
Step step_of(const Run& run, Bench& bench, size_t index, const FitOptions& options = fit_options());
/// Its newest one. Throws InputError where it has none.
Step newest_step(const Run& run, Bench& bench, const FitOptions& options = fit_options());

/// The newest step's diagnosis as written. Empty: there is none of this model.
std::optional<Diagnosis> stored_diagnosis(const Run& run, const Fitted& newest);

/// Effects that the refits of a step of `run.json` could not tell apart, the added one first; one
/// alone is no tie.
std::vector<std::string> tied_in(const nlohmann::json& step, const Limits& limits);
/// Who stood in its contest.
Contested contested_in(const nlohmann::json& step);

DiscoverOptions discover_options();

/// Writes the step's folder and the timeline's entry, which keeps the command that made it. The
/// run's verdict goes: it was about the step before. So does `search`, unless the step is of it.
std::filesystem::path record(Run& run, const Step& step, const std::string& command = invocation(),
                             bool of_search = false);
/// The lowest floor that any step of the run has shown: a model that lacks something leaves some of
/// it in the rest photos too.
void tell_floor(nlohmann::json& timeline, const Floor& floor);
/// The step with all that record() writes of its diagnosis (lacks_displaced).
Step with_displaced(Bench& bench, Step step, const std::atomic<bool>* cancel);
/// Puts a diagnosis into the newest step and the timeline. What the fit wrote stays as it is.
void record_diagnosis(Run& run, const Step& step);

/// Diagnoses the newest step and writes it down; its intervals reach for the mesh.
void diagnose_newest(Run& run, Bench& bench, Step& step, const DiagnosisOptions& options);

/// Where the photos are not explained: the forces that would explain them (free_form.h), said, and
/// written beside the newest step's diagnosis. For when no effect of the catalogue is left to try.
void tell_free_form(const Run& run, Bench& bench, const Step& step, Session& session);

/// The answer first (app/report/answer.h): said, and `answer` of the document, which is the run's
/// timeline or what the command put there before.
void say_answer(const Run& run, Session& session);

/// Names the folders of a step's pictures.
void say_pictures(const std::filesystem::path& step, const Session& session);

}  // namespace hookeye
