// Light that comes from everywhere but not evenly, as spherical harmonics up to the second order:
// a matt surface sends back 99 % of any light by them (Ramamoorthi and Hanrahan 2001, An efficient
// representation for irradiance environment maps; Basri and Jacobs 2003).
#pragma once

#include <Eigen/Core>
#include <array>

namespace hookeye {

/// What makes the light uneven: L1-1 L10 L11 L2-2 L2-1 L20 L21 L22 of the radiance
/// L(w) = sum L_lm Y_lm(w), with real Y_lm, normalised over the sphere. L00 is an even sky.
constexpr int kUnevenNumbers = 8;
using UnevenLight = Eigen::Matrix<double, kUnevenNumbers, 1>;

/// Names of all nine, L00 first.
extern const std::array<const char*, 1 + kUnevenNumbers> harmonic_names;

/// Radiance of a matt white surface under an even sky of L00 = 1: Y_00.
extern const double even_by_harmonic;

/// Light by the unit normal n that a matt white surface sends back, which is its irradiance over
/// pi: mean + b.n + n^T Q n.
struct Irradiance {
  double mean;
  Eigen::Vector3d b;
  Eigen::Matrix3d Q;  ///< symmetric, without trace

  Irradiance(double even, const UnevenLight& uneven);
  double at(const Eigen::Vector3d& n) const { return mean + n.dot(b + Q * n); }
  /// Over all normals.
  double least() const;
  double most() const;
};

/// at(n) by each of the eight numbers.
UnevenLight irradiance_by_uneven(const Eigen::Vector3d& n);

/// The light turned with R.
UnevenLight turned(const UnevenLight& light, const Eigen::Matrix3d& R);

}  // namespace hookeye
