// The text of a synthetic capture.yaml, and its truth file. Internal to synth.
#pragma once

#include <string>
#include <vector>

#include "estimation/synth/recipe.h"
#include "estimation/synth/synth_body.h"

namespace hookeye::detail {

/// A force and a moment on the grip: of the truth, or as measured.
struct GripForce {
  Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();
};

/// What turns a recipe's units into the capture's. Of a drawn shape its units are those of the
/// body, of a surface already the capture's.
struct SynthScale {
  double force = 1.0;   ///< of `force`: shear modulus times area of the grip [force]
  double length = 1.0;  ///< of `move`: height of the body [length]
};
SynthScale scale_of(const Recipe& recipe, const SynthBody& body);
/// What the noise of measured forces counts in [force]: shear modulus times area of the grip, of a
/// surface that of the example's region. That of moments: times the body's height.
double force_unit(const Recipe& recipe, const SynthBody& body, const ExampleRecipe& example);
/// "grip_faces.txt": the list of triangles of a region that is told by them.
std::string faces_file(const RegionSpec& region);

/// Cameras of the rig, looking at the axis of the body; at a surface's middle.
std::vector<Camera> make_cameras(const Recipe& recipe);

/// Standard deviation of a pixel that the noise and the rounding to levels make together.
NoiseModel told_noise(const NoiseRecipe& noise);

/// "photos/pull_cam0.png".
std::string photo_name(const Recipe& recipe, const std::string& example, const std::string& camera);

struct CaptureText {
  bool truth = false;                    ///< with the true material instead of the told one
  bool photos = false;                   ///< with the photos of all examples by all cameras
  std::vector<GripForce> measured = {};  ///< by example; empty: zeros
};
std::string capture_text(const Recipe& recipe, const SynthBody& body, const CaptureText& options);

}  // namespace hookeye::detail
