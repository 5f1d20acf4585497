// The same capture told otherwise: in another frame, in other units, in another order.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>

#include "meshing/tet_mesh.h"

namespace hookeye::test {

/// x' = length (R x + move); forces grow by `force`. Numbers of other dimensions follow.
struct Frame {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Vector3d move = Vector3d::Zero();  ///< [old length]
  double length = 1.0, force = 1.0;  ///< new units in one old
  std::string length_unit = "mm", force_unit = "N";

  Vector3d point(const Vector3d& x) const { return length * (R * x + move); }
  Vector3d step(const Vector3d& u) const { return length * (R * u); }
  double stress() const { return force / (length * length); }
  double density() const { return force / std::pow(length, 4); }
};

/// The same in metres or micrometres, for a capture in millimetres.
Frame in_metres();
Frame in_micrometres();
/// A rotation without an axis of symmetry, drawn by `seed`.
Frame turned(unsigned seed);
Frame moved(const Vector3d& by);

/// What stands in another order, drawn by `seed`. 0: as it was.
struct Order {
  unsigned nodes = 0;     ///< of the volume; its elements too
  unsigned vertices = 0;  ///< of the surface; its triangles and their corners too
  unsigned cameras = 0, examples = 0, regions = 0;
};

/// Writes the capture of folder `from` anew into the new folder `to`. Boxes become lists of faces:
/// a turned box is none. Supports must hold all components or move as a rigid body.
void write_transformed(const std::filesystem::path& from, const std::filesystem::path& to,
                       const Frame& frame, const Order& order = {});

/// Meshes the capture's surface as the capture tells and adds the mesh as its `volume:`.
void keep_own_mesh(const std::filesystem::path& folder);

}  // namespace hookeye::test
