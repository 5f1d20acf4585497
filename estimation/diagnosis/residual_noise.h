// What is left of a fitted model besides what it lacks: the noise of every photo, field and sensor,
// from what the program measures of them (method.md, "One score, in the shadow").
#pragma once

#include <string>
#include <vector>

#include "estimation/fit/evidence.h"
#include "estimation/fit/fit.h"
#include "estimation/fit/floor.h"

namespace hookeye {

/// What one channel of a photo, one field or one sensor says of a fitted model. No pixel is in it.
struct SeenPart {
  enum class Kind { textured, silhouette, field, sensor } kind = Kind::sensor;
  bool held_out = false;
  std::string camera;
  double count = 0.0;        ///< components of its cells, or numbers
  double variance = 0.0;     ///< mean square of those, in told noise
  double effective = 0.0;    ///< how many count, by the correlation of what this model leaves
  double information = 0.0;  ///< motion_information() [1/px^2]
  double pixels = 0.0, pixel_r2 = 0.0;  ///< of a photo: those that count, and |r|^2 over them
  Eigen::MatrixXd H;                    ///< J^T J of pixels, or of numbers, in told noise
  Eigen::VectorXd s;                    ///< J^T r
};

/// Fitted examples and held-out ones. `sums`: the same model once more, with a column of its own
/// behind the parameters' (what a finer mesh changes); null: the fit's own sums.
std::vector<SeenPart> seen_parts(const Fitted& fitted, const Evaluation* sums = nullptr);

/// Covariance of all that is seen, as variances of independent numbers: cells that repeat one
/// another count once. (What a finer mesh changes is a column with a prior, u u^T: score.h.)
struct ResidualNoise {
  struct Part {
    double variance = 1.0;      ///< in told noise
    double count = 0.0;         ///< independent numbers
    double share = 0.0;         ///< of its cells: weight of sums over pixels
    double pixel_floor2 = 1.0;  ///< mean |r|^2 of pixels that no model takes
  };
  std::vector<Part> parts;  ///< as seen_parts()
};

/// `reference`: of the model that misses least. The variance of a cell is that of the floor (of the
/// camera's own floor, where that is higher), or what the reference leaves where that is less, and
/// never below the noise. As many cells count as the correlation of what the reference leaves says;
/// no more than the rest photos' does; and those of a rim, which is trusted to FloorLimits::rim_px
/// alone, as much less as that is more than their noise.
ResidualNoise estimate_noise(const std::vector<SeenPart>& reference, const Floor& floor);

/// Sums in units of that noise: of photos and fields, and of sensors.
std::vector<EffectiveSums> in_noise(const std::vector<SeenPart>& parts, const ResidualNoise& noise,
                                    bool held_out);

}  // namespace hookeye
