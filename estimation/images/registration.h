// Large misfits made linear. A residual is linear in the motion only while that motion is small
// against the pattern; past it, pictures decorrelate and a shift looks like a change of brightness.
// The motion between model and photo is therefore found by dense optical flow first.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "capture_io/image.h"

namespace hookeye {

struct Registration {
  double rms_px = 0.0;  ///< motion of the model's picture that brings it onto the photo
  Image residual;       ///< (moved model - photo)/sigma, NaN where the pixel does not count
  /// grad(model).(u, v)/sigma + residual: what the residual would be if pictures were linear in
  /// the motion. Equal to the plain residual, to first order, where the motion is small.
  Image linear;
};

/// `residual` = (model - photo)/sigma with NaN where a pixel does not count. Flow: dense inverse
/// search (Kroeger, Timofte, Dai, Van Gool, ECCV 2016) of OpenCV.
Registration register_pictures(const Image& model, const Image& photo, const Image& residual,
                               const Image& sigma);

/// The same of coverage pictures, which have a motion only across their contours: from every pixel
/// of the model's rim to the photo's contour along the rim's normal (RAPiD: Harris, Stennett, BMVC
/// 1990). `linear` keeps the plain residual where no contour is found or where the motion is below
/// kStillPx. `valid`: pixels of the photo that count, empty: all.
Registration register_silhouettes(const Image& model, const Image& photo,
                                  const std::vector<unsigned char>& valid, const Image& residual,
                                  const Image& sigma);

/// Pixels near a contour of the model or of the photo, or where they differ: what a silhouette has
/// to say. The plain inside of both would only dilute it.
std::vector<unsigned char> telling_pixels(const Image& model, const Image& photo);

/// Motions below this [px] are left to the plain residual: pictures are linear in them already (a
/// pattern of 6 px period to 0.2 %).
constexpr double kStillPx = 0.1;

/// Fourth-order central differences, as flow.cpp takes them: what is added to the residual here as
/// gradient times motion is divided by the gradient there. Two pixels from the border or farther.
Eigen::Vector2d picture_slope(const Image& picture, int x, int y);

}  // namespace hookeye
