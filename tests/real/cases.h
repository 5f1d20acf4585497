// What is measured on the real captures: shared by the tests and by the figures of docs/.
#pragma once

#include <memory>
#include <string>

#include "estimation/diagnosis/diagnosis.h"
#include "real/captures.h"

namespace hookeye::real {

/// A capture folder, opened and fitted from what it tells.
struct Case {
  std::shared_ptr<const Scene> scene;
  std::unique_ptr<Workspace> workspace;
  Fitted fitted;
  /// Value and interval of a parameter by name; throws std::out_of_range.
  struct Value {
    double value, low, high;
  };
  Value parameter(const std::string& name) const;
};
/// Throws std::runtime_error with example and reason where the numbers fail.
Case fit_capture(const fs::path& folder);
Diagnosis diagnose_case(Case& fitted);
/// Every effect that could be tested, best first: evidence, share, sentence. One line each.
std::string table(const Diagnosis& diagnosis);

/// A block that CalculiX solved, solved from its deck: largest component [mm] by which a node
/// misses CalculiX's, largest that a node moves, and what the camera sees.
struct ReferenceBlock {
  double distance_mm = 0, largest_mm = 0;
  int nodes = 0;
  Image picture;
};
ReferenceBlock solve_reference(const fs::path& data, const fs::path& capture,
                               const std::string& deck);

/// chi over the photos at rest, the loaded fitted and the held-out ones.
struct ChiByKind {
  double rest = 0, loaded = 0, held_out = 0;
};
ChiByKind chi_by_kind(const Case& fitted);

/// Published displacements of an openhole step against the model's, and against the model's plus
/// the residual displacement that its picture shows [px rms of a component].
struct DicDifference {
  double model_px = 0, with_residual_px = 0, largest_px = 0;
  int points = 0, outside = 0;  ///< outside: no cell of the residual displacement there
};
DicDifference compare_with_dic(const Case& openhole, const fs::path& data, int step);

/// Force [N] that pulls the left end of a sheet in tension outwards.
double pull_N(const Case& sheet, int example);

/// The sheet with two notches, predicted with a shear modulus [MPa] of the other sheet, nothing
/// fitted. Mouths: mouth_px of the model and of the photo.
struct NotchFrame {
  int frame = 0;
  double predicted_N = 0, measured_N = 0, mouth_px = 0, seen_px = 0;
};
std::vector<NotchFrame> predict_notched(const fs::path& data, const fs::path& capture, double mu);

/// Prints how neo-Hooke, Yeoh, Ogden and the additive model fit the sheet with two holes and
/// predict the one with two notches; captures go to `out`.
void compare_laws(const fs::path& data, const fs::path& out);

/// Intersection over union of a silhouette with the model's, over the pixels that count.
double overlap(const Case& fitted, int example);

/// Width [px] of the upper notch's mouth, `below` px under its lips; 0: none found.
double mouth_px(const Image& inside, int below);

}  // namespace hookeye::real
