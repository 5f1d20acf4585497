// What the mesh tells: size, longest axis, end faces.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "meshing/surface_mesh.h"

namespace hookeye {

struct BodyFacts {
  std::filesystem::path file;
  bool is_volume = false;
  SurfaceMesh surface;  ///< of a volume its boundary
  Eigen::Vector3d low, high;
  double volume = 0;                ///< [length^3]
  Eigen::Vector3d axis;             ///< unit: the longest; a coordinate axis where that is near
  std::vector<std::string> groups;  ///< surface groups of a volume
  double diagonal() const { return (high - low).norm(); }
  /// From end to end along a direction [length].
  double length_along(const Eigen::Vector3d& direction) const;
};
/// Throws InputError.
BodyFacts body_facts(const std::filesystem::path& file, bool is_volume);

/// The end of the body towards a unit direction: the flat face there, or where there is none the
/// outermost twentieth.
struct EndRegion {
  Eigen::Vector3d point, normal;
  double area = 0;  ///< of whole triangles [length^2]
  bool flat = false;
};
EndRegion end_region(const BodyFacts& body, const Eigen::Vector3d& direction);

/// "+x", "-z", "y", "0,0.6,0.8" as a unit vector; empty: none of them.
std::optional<Eigen::Vector3d> direction_in(const std::string& text);
/// The shortest text of it.
std::string end_name(const Eigen::Vector3d& direction);

}  // namespace hookeye
