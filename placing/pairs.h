// The body's place from points that somebody picked in photos and on the body.
#pragma once

#include <string>
#include <vector>

#include "capture_io/capture.h"
#include "placing/placing.h"

namespace hookeye {

/// In this camera's picture this point of the body is seen at this pixel.
struct PickedPair {
  std::string camera;
  Eigen::Vector2d pixel;  ///< pixel centres are integers [px]
  Vector3d point;         ///< of the body at rest, in its frame [length]
  Place place;            ///< where it was told
};

/// CAMERA:u,v=x,y,z. Throws InputError at `place`.
PickedPair read_pair(const std::string& text, const Place& place);
/// A file with `CAMERA u v x y z` a line, separated by blanks, tabs, commas or semicolons; `#`
/// begins a comment. Throws InputError.
std::vector<PickedPair> read_pairs(const std::filesystem::path& file);

struct PairOptions {
  double sigma_px = 1.0;  ///< how well a pixel was picked, in u and in v
};

struct PairFit {
  Placing placing;
  std::vector<Eigen::Vector2d>
      off_px;              ///< model minus picked, by pair; NaN: the camera cannot see it
  std::vector<char> used;  ///< 0: left out
};

/// Least squares in pixels over all cameras, from starts all around. With five pairs and more,
/// those that do not go with the rest are left out. Throws InputError: an unknown camera, a pixel
/// out of the picture, fewer than three different points, points on a line, pairs that do not agree
/// with each other.
PairFit place_by_pairs(const std::vector<PickedPair>& pairs, const Capture& capture,
                       const PlacedBody& body, const PairOptions& options);

}  // namespace hookeye
