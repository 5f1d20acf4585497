// What the cameras would see of a model: the pictures of `render`.
#pragma once

#include "capture_io/capture.h"
#include "estimation/evaluation/photo_evaluation.h"

namespace hookeye {

/// Every camera looks at every example, also where the capture has no photo of it. Where the photos
/// of one example give the texture, only cameras that took one of it can.
void look_with_all_cameras(Capture& capture);

/// Linear intensities, with as many channels as the texture has for this photo; and the fraction of
/// each pixel that the body covers.
struct Sighting {
  Image picture, coverage;
};
/// Photo `k` of example `e` in the state q (3n). `q_reference`: where the photos of one example
/// give the texture, its state; else null.
Sighting look(PhotoComparer& comparer, const Model& model, int e, int k, const VectorXd& q,
              const VectorXd* q_reference);

}  // namespace hookeye
