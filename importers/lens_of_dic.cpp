#include "importers/lens_of_dic.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace hookeye::detail {

Eigen::Matrix3d cardan(double a_deg, double b_deg, double c_deg) {
  constexpr double kRadians = 3.14159265358979323846 / 180.0;
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(c_deg * kRadians, Vector3d::UnitZ()) *
          AngleAxisd(b_deg * kRadians, Vector3d::UnitY()) *
          AngleAxisd(a_deg * kRadians, Vector3d::UnitX()))
      .toRotationMatrix();
}

std::vector<double> unpublished_lens(const std::array<double, 5>& k, const std::string& system,
                                     const ImportOptions& options, const Place& place) {
  if (std::all_of(k.begin(), k.end(), [](double one) { return one == 0; })) return {};
  if (!options.lens_as_opencv)
    throw InputError(
        place, fmt::format("the lens has distortion, and {} does not publish its formula", system),
        "undistort the photos, or say that its coefficients are those of OpenCV "
        "(k1 r^2 + k2 r^4 + k3 r^6 of x/z): --lens opencv");
  return {k[0], k[1], k[3], k[4], k[2]};
}

}  // namespace hookeye::detail
