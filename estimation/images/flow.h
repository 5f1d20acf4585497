// The residual as a displacement: what motion of the surface in the picture would remove it, cell
// by cell, and how far such motions are correlated. Statistics count cells, not pixels, because
// pixels of one cell repeat one another (method.md, "Which effect is missing", 1).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "capture_io/image.h"

namespace hookeye {

/// One square cell of a photo. Within it, model - photo = grad(I) . u + I a + noise.
struct FlowCell {
  int column, row;            ///< cell indices
  Eigen::Vector2d centre_px;  ///< mean position of its pixels
  int pixels;
  Eigen::Vector3d estimate;     ///< (u_x px, u_y px, a): motion the model lacks, relative gain
  Eigen::Matrix3d information;  ///< inverse covariance of estimate under white noise
  Eigen::Vector3d z;            ///< information^(1/2) estimate: N(0, I) when only noise is left
  double explained;             ///< fall of sum r^2 in this cell by the estimate
  double r2;                    ///< sum r^2 in this cell
  bool reliable;                ///< both directions of u known to better than 1 px
  int known;                    ///< directions of estimate that its pixels tell of, at most 3
};

struct FlowField {
  int cell_px = 16;
  std::vector<FlowCell> cells;
  /// Root mean square of u over reliable cells with the noise's part removed [px]; of a
  /// silhouette's rim, across it.
  double rms_px() const;
};

/// `residual` = (model - photo)/sigma, NaN where a pixel does not count. Without `gain` a is not
/// sought: a silhouette has no brightness.
FlowField residual_flow(const Image& model, const Image& residual, const Image& sigma,
                        bool gain = true, int cell_px = 16);

/// Mean square of `residual` in the middle cell once every cell has moved, brightened, changed its
/// background and its sharpness on its own: what no model could remove. `model` and `residual` are
/// aligned. No cells: 1, the told noise.
double variance_after_free_motion(const Image& model, const Image& residual, const Image& sigma,
                                  int cell_px = 16);

/// Correlation of z over the cells of one photo.
struct FlowStatistics {
  double count = 0;     ///< components of z (FlowCell::known)
  double variance = 0;  ///< mean z^2: 1 when only noise is left
  double inflation =
      1;  ///< sum over lags of cov(z): variance of smooth signatures over white noise
  double effective = 0;  ///< N_eff = count / sum over lags of rho^2
  double whiteness_p =
      1;  ///< p-value of "neighbouring cells are uncorrelated and of unit variance"
};
FlowStatistics flow_statistics(const FlowField& flow);
/// The same of the channels of one photo, each by itself, where they repeat one another: a motion
/// is seen in all of them, and a Bayer filter's neighbours are one measurement. `inflation` and
/// `effective` count the channels' correlation at the same cell, on top of that between cells.
std::vector<FlowStatistics> flow_statistics(const std::vector<const FlowField*>& channels);

/// Pictures are linear in motions below this [px]: the finest pattern that the pixel filter passes
/// at half its contrast has a period of 6 px, of which sin(2 pi 0.3/6) is linear to 2 %.
constexpr double kLinearPx = 0.3;

}  // namespace hookeye
