// Which further load or view would best separate what is still confused (method.md, "Which effect
// is missing", 5): pictures are predicted at the fitted model, nothing is measured.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "estimation/diagnosis/diagnosis.h"

namespace hookeye {

/// A further load (one example, seen by the cameras there are) or a further view (one camera that
/// looks at the fitted examples again).
struct PlanCandidate {
  enum class Kind { load, view } kind = Kind::load;
  std::string name;   ///< of the example or camera to be: "pull_half", "tilt_1"
  std::string words;  ///< "the base tilted by 45 degrees about (1.00, 0.00, 0.00)"
  bool told = false;  ///< from the capture: an example or a camera without photos
  ExampleSpec load;   ///< Kind::load, with photos to be taken
  Camera view;        ///< Kind::view
};

/// Candidates of a capture: the examples without photos and measurements, and the cameras without
/// photos; where there are none of a kind, a grid of that kind. Loads: those of the fitted examples
/// repeated, halved, half as much again, reversed and turned by 90 degrees about the normal of what
/// is held, and the bare base tilted by 45 degrees to four sides. Views: the first camera turned
/// about the body, in steps of 45 degrees, and raised. No grid of views where the texture comes
/// from photos: nobody knows it where no camera has looked. Supports whose motion is fitted (rigid:
/// fit) keep the motion that `model` has found.
std::vector<PlanCandidate> plan_candidates(const Model& model, bool grid_too = false);

/// The lines that would tell a candidate in capture.yaml, without photo files; below `examples:` or
/// `cameras:`.
std::string capture_lines(const PlanCandidate& candidate);

/// Two effects, and what tells them apart.
struct Separation {
  std::string effect, rival;  ///< the effect's best fit, imitated by the rival and the parameters
  double cosine = 1.0;        ///< share of the signature that the rival can imitate
  double margin = 0.0;        ///< log evidence expected if the effect is there and not the rival
  double angle_deg() const;   ///< between the signatures
};

struct PlanRating {
  PlanCandidate candidate;
  Separation worst;  ///< of the confused pairs with the candidate's photos added: smallest margin
  double px = 0.0;   ///< by how much that pair's pictures would differ in these photos (rms)
  double chi = 0.0;  ///< the same in units of noise
  std::string most;  ///< photo where they differ most: "side", or "pull" for a view
  int photos = 0;
  std::vector<std::string> makes_testable;  ///< effects that the photos so far cannot test
  std::string why_not;                      ///< not rated, and why
  std::string sentence;
};

struct Plan {
  std::vector<std::string> confused;  ///< effects to be separated
  std::string leader;                 ///< effect that leads; empty: none stands out
  bool alike = false;  ///< effects that do not stand out change these photos nearly alike
  Separation now;      ///< of them, with the photos there are
  std::vector<std::string> untestable;  ///< with the photos there are
  std::vector<PlanRating> ratings;      ///< best first; those that could not be rated last
  std::string sentence;
  double tie = 0.0;  ///< DiagnosisLimits::tie: what separates at least
};

struct PlanOptions {
  std::vector<std::string>
      between;            ///< effects to be separated; empty: what the diagnosis confuses
  bool grid_too = false;  ///< the grid also where the capture tells candidates
  const std::atomic<bool>* cancel = nullptr;
  std::function<void(int done, int of)> progress;
};

/// More are a heap, not a question.
constexpr size_t kMostConfused = 4;

/// Effects of a diagnosis that nothing separates yet: leaders(), or, where there is one alone,
/// those that imitate it (cosine above 0.9) too. Fewer than two: nothing is confused.
std::vector<std::string> confused_effects(const Diagnosis& diagnosis);

/// `fitted` is the model of which `diagnosis` tells what it lacks. The expected margin counts cells
/// as the diagnosis does: new photos have the effective share of the photos by the same camera (of
/// all photos for a new one), the noise of the photos so far and the floor's variance.
Result<Plan> plan(const Fitted& fitted, const Diagnosis& diagnosis,
                  const PlanOptions& options = {});

}  // namespace hookeye
