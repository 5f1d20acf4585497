// Curves of the picture across which the intensity jumps: what is seen on their two sides, and
// their share in the derivatives of the pixels about them. Internal to render.
#pragma once

#include <algorithm>
#include <vector>

#include "render/frame.h"

namespace hookeye {

/// A point of such a curve, with the piece of it that it stands for.
struct CurvePoint {
  double length_px;                        ///< of the piece
  Vector2d px, normal;                     ///< in the picture; normal from the inside outwards
  double depth;                            ///< as Samples::depth
  Vector2d h;                              ///< ray through the point
  Vector2d step_h;                         ///< change of h for a step beside it, along the normal
  Eigen::Matrix<double, 1, 3> n_by_point;  ///< normal motion [px] by camera-space position
  Eigen::Matrix<double, 1, 7> n_by_camera;
};

/// Sets all of `out`. `p`: the point; `along`: `pieces` times its piece; `inwards`: away from the
/// outside; all in camera axes [length]. The step is at least `step_px` and long enough for rays of
/// floats to be beside the curve. False where the curve shrinks to a point.
bool place(const View& view, const Vector3d& p, const Vector3d& along, const Vector3d& inwards,
           int pieces, double step_px, CurvePoint* out);

/// Inside less outside: of the body's intensity and of the share of what is behind it.
struct Jump {
  double I, behind;
};

/// Adds the share of a point in all pixels whose filter reaches it: `motion` (of the curve along
/// its normal [px]; its pixel is ignored) times the jump. Neighbouring points mostly meet the same
/// pixels: a segment of the same pixel and triangle among the last `back` takes the share.
void spread(const Frame& frame, const PixelFilter& filter, const CurvePoint& point,
            const Jump& jump, const EdgeSegment& motion, size_t back,
            std::vector<EdgeSegment>* out);
/// On a contour the pixels of a narrow filter; where there are many curves or triangles, those of
/// the neighbouring point in any filter and a few more.
constexpr size_t kShortBack = 4, kLongBack = 48;

/// Calls use(point, samples, shading, i) for all points, which are CurvePoints: lane i is what is
/// seen a step inside, lane i + 1 a step outside.
template <class Point, class Use>
void look_beside(const Frame& frame, const std::vector<Point>& points, const Use& use) {
  constexpr size_t kPairs = kLanes / 2;
  for (size_t begin = 0; begin < points.size(); begin += kPairs) {
    const int count = static_cast<int>(std::min(kPairs, points.size() - begin));
    Vector2d h[kLanes];
    Samples samples;
    Shading shading;
    for (int i = 0; i < count; ++i) {
      h[2 * i] = points[begin + i].h - points[begin + i].step_h;
      h[2 * i + 1] = points[begin + i].h + points[begin + i].step_h;
    }
    trace(frame, h, 2 * count, &samples);
    shade(frame, samples, false, &shading);
    for (int i = 0; i < count; ++i) use(points[begin + i], samples, shading, 2 * i);
  }
}

}  // namespace hookeye
