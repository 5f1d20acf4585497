// The body's place from a scan of it, whole or in part, in the frame of the cameras.
#pragma once

#include <filesystem>
#include <functional>

#include "placing/placing.h"

namespace hookeye {

struct ScanOptions {
  double scale = 1.0;         ///< length units of the capture in one of the scan's
  size_t most_points = 4000;  ///< of the scan, for the figures; starts are tried with fewer
  /// Told after each start: how many are done, of how many.
  std::function<void(size_t done, size_t of)> progress = {};
};

struct ScanFit {
  Placing placing;       ///< misfit: distance of the points used to the surface [length]
  double used = 0.0;     ///< share of the scan's points that lie on the body
  double covered = 0.0;  ///< share of the body's surface that they cover
};

/// `scan` in the cameras' frame; `told`: where the capture tells the body there. Points go to the
/// nearest plane of the surface that faces as they do (Chen, Medioni 1992), those that lie far off
/// (a stand, a hand) are left out. From starts all around. Throws InputError at `place`: too few
/// points, another size than the body's.
ScanFit place_by_scan(const SurfaceMesh& scan, const Place& place, const ToldPlacement& told,
                      const PlacedBody& body, const ScanOptions& options);

}  // namespace hookeye
