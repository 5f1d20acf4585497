// What the commands on a run share: runs/ with the progress bar, Ctrl-C and the session wired in.
#pragma once

#include "app/invocation.h"
#include "app/session.h"
#include "runs/bench.h"
#include "runs/failed.h"
#include "runs/record.h"
#include "runs/tables.h"
#include "runs/versions.h"

namespace hookeye {

Warn warn_to(Session& session);
void warn_of_doubts(const Scene& scene, Session& session);
Bench open_capture(const std::filesystem::path& path, Session& session, const Limits& limits = {});

/// Options with the progress bar and Ctrl-C wired in.
FitOptions fit_options();
DiagnosisOptions diagnosis_options();
DiscoverOptions discover_options();
Step newest_step(const Run& run, Bench& bench);

/// runs/record.h's, and said.
void tell_free_form(const Run& run, Bench& bench, const Step& step, Session& session);

/// The answer first (runs/report/answer.h): said, and `answer` of the document, which is the run's
/// timeline or what the command put there before.
void say_answer(const Run& run, Session& session);

/// Names the folders of a step's pictures.
void say_pictures(const std::filesystem::path& step, const Session& session);

}  // namespace hookeye
