// What a blind run found against what was hidden, and the tables of many.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace hookeye::blind {

struct Score {
  std::string hidden;         ///< the effect's name, "none"
  unsigned seed = 0;
  std::string status = "ok";  ///< else what went wrong: "synth 3", "discover 3"
  std::string first = "none"; ///< first named effect
  std::vector<std::string> added, tie;
  std::string verdict;
  double hidden_px = 0.0;     ///< size of the hidden effect
  double floor = 0.0, fit_before = 0.0, fit_after = 0.0, held_before = 0.0, held_after = 0.0;
  double seconds = 0.0;

  bool right_first() const { return first == hidden; }
  /// The right name, or a tie that was declared and holds it.
  bool right_or_tie() const;
};

/// `run`: what `discover --json` printed; `truth`: CAPTURE.truth.json.
Score score(const nlohmann::json& run, const nlohmann::json& truth);

std::string csv(const std::vector<Score>& scores);
/// Counts over everything that ran, as lines for people.
std::string summary(const std::vector<Score>& scores);
/// Rows: what was hidden; columns: what was named first.
std::string confusion_svg(const std::vector<Score>& scores);

}  // namespace hookeye::blind
