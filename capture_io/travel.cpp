#include "capture_io/travel.h"

namespace hookeye {

Eigen::Vector3d prescribed_travel(const SupportSpec& support) {
  if (support.kind != SupportSpec::Kind::components) return support.rigid.move;
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) u[k] = support.displacement[static_cast<size_t>(k)].value_or(0.0);
  return u;
}

}  // namespace hookeye
