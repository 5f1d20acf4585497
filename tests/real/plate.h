// Flat bodies with holes, as one would draw them from a caliper: a msh file for `volume:`.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

namespace hookeye::real {

/// Polygon (counter-clockwise, z up) with round holes, from z = -thickness to z = 0 (the face that
/// the camera sees lies in z = 0). Lengths in one unit of the user's choice.
struct Plate {
  struct Corner {
    Eigen::Vector2d at;
    double edge;  ///< of the tetrahedra here
  };
  struct Hole {
    Eigen::Vector2d centre;
    double radius, edge;
  };
  std::vector<Corner> outline;
  std::vector<Hole> holes;
  double thickness = 1.0;
  int layers = 1;  ///< over the thickness
};

/// Quadratic tetrahedra with straight edges, msh 4.1.
void write_plate(const std::filesystem::path& msh, const Plate& plate);

}  // namespace hookeye::real
