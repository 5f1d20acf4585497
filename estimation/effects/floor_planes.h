// The planes of floor_contact: those that are scored, those that are refitted, and how variants
// tell them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "estimation/model/model.h"

namespace hookeye {

/// "+x", "-x", "+y" ...
extern const char* const kSides[6];
/// Outward direction of a side of the body.
Vector3d outward(int side);

/// "(0.851, 0.526, 0)".
std::string digits(const Vector3d& v);

/// A half space that is not free, behind the plane through `through`; `out` points into it.
struct Plane {
  Vector3d out, through;
};

/// A plane of the scores: normal to an axis of the frame ("at +x side"), or to another direction.
struct ScoredPlane {
  Vector3d out;
  double position;  ///< along `out` [length]
  std::string text;
};
ScoredPlane on_side(int side, double position);
ScoredPlane towards(const Vector3d& direction, double position);
/// Either of them, at a position to digits of the body's size: written, it reads back the same.
ScoredPlane plane_at(const Vector3d& direction, double position, double size);
/// Empty: `variant` tells none.
std::optional<ScoredPlane> scored_plane(const std::string& variant);

/// A plane of the refits: it stands along `out` on the line through `about` and, where it may tilt,
/// does so about that place. Normal to an axis it may also be told by its side, without tilt.
struct PlaneForm {
  bool hard = false, tilts = false;
  int side = -1;  ///< -1: tilts
  Vector3d out = Vector3d::Zero(), about = Vector3d::Zero();
  /// Of a hard one. It is written, as the modulus that it was taken from is fitted further.
  double stiffness = 0.0;

  std::string variant() const;
  /// `values`: position, stiffness of a cushion, two tilts.
  Plane plane(const VectorXd& values) const;
};
/// Empty: `variant` tells none.
std::optional<PlaneForm> plane_form(const std::string& variant);

}  // namespace hookeye
