// What `place` says of the photos: how well the model's outline lies on theirs, before and after.
#pragma once

#include <Eigen/Geometry>

#include "app/session.h"
#include "estimation/inspection/inspection.h"
#include "estimation/model/model.h"

namespace hookeye {

/// The photos at rest of `scene` as told, and with the body moved (in its frame as told). `out`: a
/// folder for pictures of the latter, as `check` draws them; may be empty. Returns what
/// contradicts the new place; it is not said yet.
std::vector<CaptureWarning> look_before_and_after(const Scene& scene,
                                                  const Eigen::Isometry3d& motion,
                                                  const std::string& out, Session& session);

}  // namespace hookeye
