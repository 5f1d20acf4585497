#include "capture_io/light_harmonics.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace hookeye {
namespace {

using Eigen::Vector3d;

/// Evenly over the sphere.
std::vector<Vector3d> directions(int count) {
  std::vector<Vector3d> out;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, a = i * EIGEN_PI * (3.0 - std::sqrt(5.0));
    out.push_back({std::sqrt(1.0 - z * z) * std::cos(a), std::sqrt(1.0 - z * z) * std::sin(a), z});
  }
  return out;
}

/// Radiance as Ramamoorthi and Hanrahan print the harmonics (2001, equation 3).
double radiance(double L00, const UnevenLight& L, const Vector3d& w) {
  const double x = w.x(), y = w.y(), z = w.z();
  return 0.282095 * L00 + 0.488603 * (L[0] * y + L[1] * z + L[2] * x) +
         1.092548 * (L[3] * x * y + L[4] * y * z + L[6] * x * z) +
         0.315392 * L[5] * (3 * z * z - 1) + 0.546274 * L[7] * (x * x - y * y);
}

UnevenLight some_light(double phase = 0.0) {
  UnevenLight L;
  for (int k = 0; k < kUnevenNumbers; ++k) L[k] = std::sin(1.7 * k + 1.0 + phase);
  return L;
}

TEST(LightHarmonics, SendBackWhatTheRadianceSendsIn) {
  const UnevenLight L = some_light();
  const double L00 = 2.5;
  const Irradiance E(even_by_harmonic * L00, L);
  const auto from = directions(20000);
  for (const Vector3d& n : directions(17)) {
    double sum = 0.0;
    for (const Vector3d& w : from) sum += radiance(L00, L, w) * std::max(0.0, n.dot(w));
    EXPECT_NEAR(E.at(n), 4.0 * sum / double(from.size()), 2e-4);
    EXPECT_NEAR(E.at(n), E.mean + irradiance_by_uneven(n).dot(L), 1e-12);
  }
}

TEST(LightHarmonics, KnowTheirDarkestAndBrightestNormal) {
  UnevenLight first = UnevenLight::Zero(), axial = first, along = first, hard = first;
  first[1] = 0.7;   // no second order
  axial[5] = -0.7;  // no first order, two eigenvalues alike
  along[1] = 0.1;   // the first order lies along an axis of the second, on which the
  along[5] = 1.0;   //   least value is not
  hard[2] = 0.2, hard[7] = 1;
  for (const UnevenLight& L : {some_light(), some_light(2.0), UnevenLight(UnevenLight::Zero()),
                               first, axial, along, hard}) {
    const Irradiance E(0.3, L);
    double least = 1e9, most = -1e9;
    for (const Vector3d& n : directions(40000))
      least = std::min(least, E.at(n)), most = std::max(most, E.at(n));
    EXPECT_NEAR(E.least(), least, 1e-3 * (1e-9 + L.norm()));
    EXPECT_NEAR(E.most(), most, 1e-3 * (1e-9 + L.norm()));
    EXPECT_LE(E.least(), least + 1e-12);
    EXPECT_GE(E.most(), most - 1e-12);
  }
}

TEST(LightHarmonics, TurnWithTheLight) {
  const UnevenLight L = some_light();
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(2.1, Vector3d(0.4, -0.7, 0.2).normalized()).toRotationMatrix();
  const UnevenLight there = turned(L, R);
  EXPECT_GT((there - L).norm(), 0.5);
  for (const Vector3d& w : directions(50))
    EXPECT_NEAR(radiance(1.0, there, R * w), radiance(1.0, L, w), 1e-5);
  EXPECT_LT((turned(there, R.transpose()) - L).norm(), 1e-12);
}

}  // namespace
}  // namespace hookeye
