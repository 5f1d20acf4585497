// A capture whose body lies elsewhere than it tells: photos of a known place, drawn by the
// renderer.
#pragma once

#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "estimation/model/model.h"
#include "placing/placing.h"
#include "support/temporary_folder.h"

namespace hookeye::test {

enum class Shape {
  bracket,  ///< an L with a slanted top: looks alike from no two sides
  brick,    ///< 40 x 24 x 14: half a turn about an axis shows nothing
  cone      ///< cut off, of 48 sides: turns about z show nothing
};

struct PlacedSetup {
  Shape shape = Shape::bracket;
  int cameras = 2;
  bool silhouettes = true;  ///< else grey photos before black
  Eigen::Vector2i size{320, 240};
};

class PlacedCapture {
 public:
  /// The body lies at true_place(); capture.yaml tells the place without `off`, a motion in the
  /// body's frame: placing has to find it.
  explicit PlacedCapture(const PlacedSetup& setup, const Isometry3d& off);

  std::filesystem::path file() const { return folder_ / "capture.yaml"; }
  const TemporaryFolder& folder() const { return folder_; }
  const Capture& capture() const { return scene_->capture; }  ///< as told
  const Scene& scene() const { return *scene_; }
  PlacedBody body() const { return placed_body(scene_->body->surface.mesh, "mm"); }
  const ToldPlacement& told() const { return told_; }
  static Isometry3d true_place();

  /// Where camera c truly sees a point of the body.
  Eigen::Vector2d truly_seen(size_t c, const Vector3d& X) const;
  /// Mean distance of the surface's points between `found` and the truth [length].
  double off(const Isometry3d& found) const;

 private:
  TemporaryFolder folder_;
  Isometry3d off_;
  ToldPlacement told_;
  std::shared_ptr<const Scene> scene_;
};

/// Turned about the body's middle by `degrees` and shifted by `length`, each in a random direction.
Isometry3d random_motion(const Vector3d& middle, double degrees, double length,
                         std::mt19937& random);

/// The middle of the surface of a shape.
Vector3d middle_of(Shape shape);

}  // namespace hookeye::test
