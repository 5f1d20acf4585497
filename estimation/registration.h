// Large misfits made linear. A residual is linear in the motion only while that motion is small
// against the pattern; past it, pictures decorrelate and a shift looks like a change of brightness.
// The motion between model and photo is therefore found by dense optical flow first.
#pragma once

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

}  // namespace hookeye
