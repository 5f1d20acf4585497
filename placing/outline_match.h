// The model's outline against the photos', at one place of the body.
#pragma once

#include "estimation/inspection/body_view.h"
#include "placing/outline.h"
#include "placing/placing.h"

namespace hookeye {

/// Where a point of the model's rim should go, in one photo: along `across` by `by`.
struct RimPull {
  int photo;
  Vector3d point;          ///< of the body
  Eigen::Vector2d seen;    ///< where it is seen now [px]
  Eigen::Vector2d across;  ///< unit
  double by;               ///< [px]
};

/// One size of the photos, and what the model is drawn with.
class OutlineMatch {
 public:
  OutlineMatch(const Scene& scene, const PlacedBody& body, std::vector<Outline> outlines);
  const std::vector<Outline>& outlines() const { return outlines_; }

  /// Both ways: from the model's rim to the photo's outline, and from the photo's rim back. Empty:
  /// the body is in none of the pictures.
  std::vector<RimPull> pulls(const Isometry3d& motion);
  PoseTerms terms(const std::vector<RimPull>& pulls) const;

  /// Downhill from `start` by drawing the model again and again. `misfit`: root mean square of the
  /// pulls, those longer than a tenth of the body's picture cut there [px of the photos].
  struct Settled {
    Isometry3d motion = Isometry3d::Identity();
    double misfit = INFINITY;
  };
  Settled settle(const Isometry3d& start, int rounds);

  /// `motion` with the body's middle shifted to where the photos show it, and in one camera alone
  /// to the distance at which it is as large.
  Isometry3d centred(const Isometry3d& motion) const;

  double misfit(const std::vector<RimPull>& pulls) const;

 private:
  Camera seen_by(const Outline& outline, const Isometry3d& motion) const;
  void pull_photo(int photo, const Isometry3d& motion, std::vector<RimPull>* out);

  const PlacedBody& body_;
  std::vector<Outline> outlines_;
  inspection::BodyView view_;
};

}  // namespace hookeye
