// One look at the model: equilibrium of every example, pictures against photos, and the normal
// equations by every parameter (method.md, Fit).
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/numerical_failure.h"
#include "estimation/images/flow.h"
#include "estimation/model/model.h"
#include "render/condensed.h"
#include "simulation/equilibrium.h"

namespace hookeye {

/// For a step that may be refused, from a state in equilibrium: Newton finds what is there in some
/// ten iterations, load steps and all in some forty.
constexpr int kStepIterations = 60;

struct EvaluationOptions {
  bool derivatives = true;
  bool pictures = false;   ///< keep model, residual and flow
  bool residuals = false;  ///< keep model and residual, without the flow
  bool fitted = true;      ///< examples with use: fit
  bool held_out = false;   ///< examples with use: validate
  std::vector<int> only;   ///< these examples whatever their use; empty: by the two flags above
  /// Residuals made linear in the motion (registration.h): `sums`, their cost and the pictures.
  /// Where only pictures are asked for, `sums` alone are of those.
  bool registered = false;
  int level = 0;  ///< pyramid level: 0 = full size, each level halves
  /// Photos that are read halved or in part of their tiles are compared in all pixels that the
  /// camera took (PhotoEvaluation says what is of those). Reads their files again.
  bool all_pixels = false;
  int tile_px = 1024;     ///< of those: side of the tiles, a multiple of 16; memory follows it
  int rays_per_axis = 0;  ///< of a pixel at full size: fewer are quicker, and aliased; 0: enough
  /// Huber's threshold in units of noise; 0: squares.
  double huber = 0.0;
  double measured_weight = 1.0;  ///< Evaluation's
  /// Of the equilibrium (EquilibriumOptions).
  double tolerance = EquilibriumOptions{}.tolerance;
  int most_iterations = EquilibriumOptions{}.most_iterations;
  const std::atomic<bool>* cancel = nullptr;
  /// Equilibria and comparisons that are done, of all; called by any thread, several at once.
  std::function<void(int done, int of)> progress;
};

struct PhotoEvaluation {
  int example = 0, photo = 0, plane = 0;
  CondensedPhoto sums;  ///< over all columns; r2 is the Huber cost when that is on
  double r2 = 0.0;      ///< plain sum of squared residuals over noise
  double count = 0.0;
  /// Pictures or residuals only: linear intensity; over noise, NaN = not counted.
  Image model, residual;
  std::vector<int> triangle;  ///< pictures only: of the render surface, by pixel; -1: none
  /// Pictures only: what motion would remove the residual (large motions included,
  /// registration.h), what is left once the pictures are aligned, and the sum of squares of the
  /// residual made linear, which `sums` hold too when pictures are on.
  FlowField flow, aligned;
  double linear_r2 = 0.0;
  /// Pictures of textured photos only: variance_after_free_motion() of the aligned pictures.
  double free_variance = 1.0;
  double motion_px = 0.0;  ///< registered: rms motion between model and photo
  /// all_pixels: the same as r2 and count of the pixels that the camera took, as are `sums`. All
  /// else is of pixels of the size that is read, without those between tiles being left out.
  double taken_r2 = 0.0, taken_count = 0.0;
  double chi() const;
};

/// What a sensor told (MeasuredSpec).
struct MeasuredEvaluation {
  int example = 0, index = 0;
  VectorXd predicted, r;  ///< r: predicted less value, in standard deviations
  Eigen::MatrixXd J;      ///< dr/dp
  /// Of a field, else 0: how many independent numbers it is. Where derivatives were asked for, its
  /// r and J have a row for each column and one more, with all products of the whole ones.
  double numbers = 0.0;
  /// Of a field: variance of the sum of r over a piece of surface, over what `numbers` says of it.
  /// Noise that was told too small, or that hangs together farther, and misfit make it more than 1.
  double inflation = 1.0;
  double effective = 0.0;  ///< of a field: how many of `numbers` count (FieldSpec::effective)
  bool is_field() const { return numbers > 0.0; }
  double size() const { return is_field() ? numbers : static_cast<double>(r.size()); }
};

struct ExampleEvaluation {
  int example = 0;
  bool held_out = false;
  std::shared_ptr<const Equilibrium> equilibrium;  ///< without its factor
  Eigen::MatrixXd S;                               ///< dq/dp, 3n x columns
  std::vector<PhotoEvaluation> photos;
  std::vector<MeasuredEvaluation> measured;
};

struct Evaluation {
  std::vector<ExampleEvaluation> examples;
  int columns = 0;
  /// Of the squares of what sensors tell beside those of pixels and of fields, over the noise of
  /// each. What a
  /// renderer gets wrong is correlated from pixel to pixel: a million of them would bend a force by
  /// any number of its deviations to fit that. (floor.h)
  double measured_weight = 1.0;
  const ExampleEvaluation* find(int example) const;
  /// What chi() is of: photos; where no example has one, fields; where none has one, sensors.
  enum class Seen { photos, fields, sensors };
  Seen seen() const;
  /// Root mean square of residuals over noise, of what is seen.
  double chi(bool held_out) const;
  /// Of forces, moments and positions over their told noise; 0: none is measured.
  double measured_chi(bool held_out) const;
  double field_chi(bool held_out) const;   ///< of fields over theirs; 0: none is measured
  double linear_chi(bool held_out) const;  ///< the same from linear_r2 (needs pictures)
  double rms_px(bool held_out) const;      ///< of the residual displacement (needs pictures)
  double motion_px() const;  ///< the same, cruder, of all photos here (needs registered)
};

/// Once a process: evaluations ask for hundreds of MB and give them back, time and again. What was
/// given back stays with the process instead of being cleared by the kernel each time (a fifth of
/// an iteration with 100 parameters). Where the C library is not glibc, nothing happens.
void keep_freed_memory();

class Archive;

/// Keeps solvers, renderers and photo pyramids of a scene between evaluations. One at a time.
/// Evaluating a form of another scene (a finer mesh) moves the workspace there.
class Workspace {
 public:
  explicit Workspace(std::shared_ptr<const Scene> scene);
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  const Scene& scene() const;

  /// Columns: parameters of `form` at `p`, then those of `candidates` at their null values.
  Result<Evaluation> evaluate(
      const ModelForm& form, const VectorXd& p, const EvaluationOptions& options,
      const std::vector<std::shared_ptr<const Ingredient>>& candidates = {});

  /// All that the next evaluation takes over from those before it.
  struct Place {
    std::shared_ptr<const Scene> scene;
    std::vector<VectorXd> q;  ///< deformed positions by example, 3n; empty: starts from rest
  };
  Place place() const;
  /// The next evaluation starts there whatever has been before: factors and derivatives are
  /// forgotten, so that the same question asked from the same place has the same answer in every
  /// bit.
  void start_from(const Place& place);

  /// What fits, trials and diagnoses in this workspace are kept in, and found. Null: nothing is.
  void keep_in(std::shared_ptr<Archive> archive);
  Archive* archive() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::shared_ptr<Archive> archive_;
};

/// flow_statistics() of every photo of an example, in their order; the channels of one photo
/// together.
std::vector<FlowStatistics> photo_statistics(const std::vector<PhotoEvaluation>& photos);

/// Camera::colour_zoom stands after what a picture of one colour depends on.
constexpr int kColourZoom = kPhotoColumns, kPhotoNumbers = kColourZoom + 2;
/// The local numbers b - a of two photo states (kPhotoNumbers).
VectorXd photo_difference(const PhotoState& a, const PhotoState& b);

/// Cameras and photos at a pyramid level.
Camera camera_at_level(const Camera& camera, int level);

}  // namespace hookeye
