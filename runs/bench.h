// A capture opened for estimation, and a run opened beside it.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "capture_io/run.h"
#include "estimation/search/discover.h"

namespace hookeye {

/// Told what is most likely not meant, a sentence each; may be empty.
using Warn = std::function<void(const std::string& sentence)>;

/// A capture opened for estimation. The scene is as told; the workspace follows the model, which
/// may live on a finer mesh.
struct Bench {
  Capture capture;                     ///< with the examples that no fit may see (use: test)
  std::shared_ptr<const Scene> scene;  ///< without them
  Workspace workspace;
};
/// What reading mended, and what is most likely not meant.
void warn_of_doubts(const Scene& scene, const Warn& warn);

/// `limits`: what a run keeps of them, or the standard.
Bench open_capture(const std::filesystem::path& path, const Warn& warn, const Limits& limits = {});
Bench bench_of(const Capture& capture, const Warn& warn, const Limits& limits = {});

/// Run::open() and Run::create(), and the timeline holds what the commands read in it.
Run open_run(const std::filesystem::path& folder, bool write);
Run create_run(const std::filesystem::path& folder, const std::filesystem::path& capture);

/// A step of a run, its model evaluated again (pictures and derivatives). Throws Failed.
Step step_of(const Run& run, Bench& bench, size_t index, const FitOptions& options);
/// Its newest one. Throws InputError where it has none.
Step newest_step(const Run& run, Bench& bench, const FitOptions& options);

/// The newest step's diagnosis as written. Empty: there is none of this model.
std::optional<Diagnosis> stored_diagnosis(const Run& run, const Fitted& newest);

}  // namespace hookeye
