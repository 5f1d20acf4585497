// The text of a synthetic capture.yaml, and its truth file. Internal to synth.
#pragma once

#include <string>
#include <vector>

#include "estimation/recipe.h"
#include "estimation/synth_body.h"

namespace hookeye::detail {

/// A force and a moment on the grip: of the truth, or as measured.
struct GripForce {
  Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();
};

/// What turns a recipe's units into the capture's.
struct SynthScale {
  double force = 0.0;   ///< shear modulus times area of the grip [force]
  double height = 0.0;  ///< of the body [length]
  Vector3d grip = Vector3d::Zero(), side = Vector3d::Zero();  ///< centroids [length]
  const Vector3d& centre(const std::string& region) const { return region == "side" ? side : grip; }
};
SynthScale scale_of(const Recipe& recipe, const SynthBody& body);

/// Cameras of the rig, looking at the axis of the body.
std::vector<Camera> make_cameras(const Recipe& recipe);

/// Standard deviation of a pixel that the noise and the rounding to levels make together.
NoiseModel told_noise(const NoiseRecipe& noise);

/// "photos/pull_cam0.png".
std::string photo_name(const Recipe& recipe, const std::string& example, const std::string& camera);

struct CaptureText {
  bool truth = false;   ///< with the true material instead of the told one
  bool photos = false;  ///< with the photos of all examples by all cameras
  std::vector<GripForce> measured = {};  ///< by example; empty: zeros
};
std::string capture_text(const Recipe& recipe, const SynthBody& body, const CaptureText& options);

}  // namespace hookeye::detail
