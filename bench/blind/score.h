// What a blind run found against what was hidden, and the tables of many.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace hookeye::blind {

struct Score {
  std::string hidden;  ///< names joined by "+", or "none"
  unsigned seed = 0;
  std::string status = "ok";   ///< else what went wrong: "synth 3", "discover 3"
  std::string first = "none";  ///< first named effect that is not numerical
  /// Everything that the last model has beyond the base. A numerical effect among it
  /// (mesh_resolution) is no name for what was hidden: the captures are made on a finer mesh, so it
  /// tells the truth.
  std::vector<std::string> added, tie;
  std::string verdict;
  bool left_out = false;  ///< the hidden effects were not in the catalogue
  /// Of the left-out effects, those that the photos still show beside what the search ended with
  /// (named_beside). Nothing: not asked, as it was not explained by another.
  std::optional<std::vector<std::string>> missed;
  double hidden_px = 0.0;  ///< size of the first hidden effect
  double floor = 0.0, fit_before = 0.0, fit_after = 0.0, held_before = 0.0, held_after = 0.0;
  double seconds = 0.0;
  /// The last model's numbers against the truth's, where it has those of the truth (other variants
  /// have other names): the base material's and the hidden effects', each over the largest true
  /// value of its unit and effect. Empty: none.
  std::optional<double> material_error, effect_error;  ///< the largest
  int values = 0, inside = 0;  ///< compared, and in how many 95 % intervals the truth lies

  /// A hidden one; where they were left out of the catalogue: no other name explains them.
  bool right_first() const;
  /// The right name, or a tie that was declared and holds one.
  bool right_or_tie() const;
  /// The hidden effects were left out, and other names are told to explain the photos.
  bool explained_by_another() const;
  /// So it is, and a diagnosis by the whole catalogue finds nothing of the hidden effects left: to
  /// these photos what was named is the same.
  bool explained_by_double() const;
  /// Just the hidden ones were added, beside numerical effects.
  bool exact_set() const;
};

/// `run`: what `discover --json` printed; `truth`: CAPTURE.truth.json.
Score score(const nlohmann::json& run, const nlohmann::json& truth);

/// Of `effects`, those that the diagnosis which `diagnose --json` printed would name.
std::vector<std::string> named_beside(const nlohmann::json& diagnosis,
                                      const std::vector<std::string>& effects);

std::string csv(const std::vector<Score>& scores);
/// Counts over everything that ran, as lines for people.
std::string summary(const std::vector<Score>& scores);
/// A row for each effect (or several at once), in Markdown; medians over its captures.
std::string table(const std::vector<Score>& scores);
/// Rows: what was hidden; columns: what was named, first or later, or declared a tie.
std::string confusion_svg(const std::vector<Score>& scores);

}  // namespace hookeye::blind
