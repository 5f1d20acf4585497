// Fields of strains, as programs for digital image correlation write them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace hookeye {

/// Of the surface's tangents T at rest (orthonormal) and A = F T, C = A^T A.
enum class StrainMeasure {
  green,        ///< Green-Lagrange: (C - 1)/2
  hencky,       ///< logarithmic: log(C)/2
  biot,         ///< C^(1/2) - 1
  engineering,  ///< of the lines along T: their elongations, and half of the angle's change
  small         ///< symmetric part of T^T (A - T)
};
/// "green", ...: in the order of StrainMeasure.
const std::vector<std::string>& strain_measures();
const std::string& name_of(StrainMeasure measure);

/// "Lagrange" and what else programs call them; "": no name of a measure; one that is not known
/// here ("almansi") comes back as it is known to others.
std::string measure_called(const std::string& word);

/// A fraction in one of the unit that stands in a head ("%", "mm/m"); 0: it is no unit of strains.
double fraction_in(const std::string& unit);

struct StrainSpec {
  StrainMeasure measure = StrainMeasure::green;
  /// Diameter of the disc in whose points a plane gives the gradient [length]; 0: pointwise.
  double gauge = 0.0;
  bool gauge_told = false;
  /// In the capture's frame: exx is along the first, laid into the surface; the second tells to
  /// which side of it eyy is.
  Eigen::Matrix<double, 3, 2> axes = Eigen::Matrix<double, 3, 2>::Identity();
  Eigen::VectorXd sigma;  ///< by component
  /// Displacements of the points that stand beside the strains, in the capture's frame [length];
  /// no columns: the file has none. Not finite where a row has none.
  Eigen::Matrix3Xd u;
  int u_components = 0;
};

}  // namespace hookeye
