#include "meshing/extent.h"

#include <cmath>

namespace hookeye {

double extent(const Eigen::Matrix3Xd& X) {
  if (X.cols() == 0) return 0.0;
  double longest = 0.0;
  Eigen::Vector3d from = X.rowwise().mean();
  while (true) {
    Eigen::Index farthest = 0;
    const double distance =
        std::sqrt((X.colwise() - from).colwise().squaredNorm().maxCoeff(&farthest));
    // the first is from the middle, and half of what follows at least
    if (!(distance > longest)) return longest;
    longest = distance;
    from = X.col(farthest);
  }
}

}  // namespace hookeye
