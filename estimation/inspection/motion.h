// How the body moved from one photo to another, and how the first guess says that it would.
#pragma once

#include <vector>

#include "estimation/inspection/sight.h"

namespace hookeye::inspection {

/// Material points that are seen in the reference photo and found again in a loaded one.
struct Motion {
  PhotoIndex photo, reference;
  /// Of the small reference photo, where each is seen: the same point in all its motions.
  std::vector<int> pixel;
  std::vector<int> triangle;        ///< of the render surface
  std::vector<Eigen::Vector2f> uv;  ///< barycentric there
  std::vector<Vector2d> seen;       ///< motion in the photo [px of the photo]
  int sought = 0;                   ///< patches, found or not
};

/// Empty `seen` where too few are found.
Motion seen_motion(Sight& sight, PhotoIndex photo, PhotoIndex reference);

/// Motions of the same points in the picture, to first order in the displacement `u` of the
/// surface's vertices (3 x nv) from rest [px].
std::vector<Vector2d> first_order_motion(const Sight& sight, const Motion& motion,
                                         const Matrix3Xd& u);
/// The same between two states of the surface.
std::vector<Vector2d> motion_between(const Sight& sight, const Motion& motion,
                                     const Matrix3Xd& from, const Matrix3Xd& to);

/// Seen against expected motions, over all points of several photos.
struct MotionSums {
  double seen2 = 0, expected2 = 0, both = 0, count = 0;
  void add(const std::vector<Vector2d>& seen, const std::vector<Vector2d>& expected);
  double seen_px() const;      ///< rms
  double expected_px() const;  ///< rms
  /// 1: the same direction everywhere, -1: the opposite one. 0 where one of them is nothing.
  double cosine() const;
  /// How many times the expected motion is seen.
  double times() const { return expected2 > 0.0 ? both / expected2 : 0.0; }
};

}  // namespace hookeye::inspection
