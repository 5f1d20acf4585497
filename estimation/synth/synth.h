// Captures made from a recipe: a body with a known model and a hidden effect, solved and
// photographed otherwise than a fit will do it. The tests, the demo and the blind benchmark share
// it.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/numerical_failure.h"
#include "estimation/synth/recipe.h"

namespace hookeye {

struct SynthOptions {
  /// A command that photographs in place of our renderer (docs/synth.md, "Another photographer").
  std::string photographer;
  const std::atomic<bool>* cancel = nullptr;
  /// Called with what is done next ("solving", "photographing pull"); from several threads.
  std::function<void(const std::string&)> progress;
};

struct Synthesis {
  std::filesystem::path capture, truth;  ///< the folder and the truth file beside it
  int nodes = 0, photos = 0;             ///< nodes of the truth's mesh
  /// Per hidden effect: what it is, in a sentence, and how far it moves the pictures, rms over the
  /// surface and the fitted examples [px].
  struct Hidden {
    std::string effect, sentence;
    double rms_px;
  };
  std::vector<Hidden> hidden;
};

/// CAPTURE.truth.json for the capture folder CAPTURE. No other command reads it.
std::filesystem::path truth_file(const std::filesystem::path& capture);

/// Writes the capture folder `out` (which must not exist) whole or not at all, the truth beside it.
/// Throws InputError for what the recipe asks and the body or the catalogue cannot give.
Result<Synthesis> synthesize(const Recipe& recipe, const std::filesystem::path& out,
                             const SynthOptions& options = {});

}  // namespace hookeye
