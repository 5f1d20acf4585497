// Interpolation in pictures with gradients. Internal to render.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "capture_io/image.h"

namespace hookeye {

struct Lookup {
  double value;
  Eigen::Vector2d gradient;  ///< by the coordinates that were asked for
};

/// Cubic B-spline through the pixels of a picture (Unser 1999), mirrored at the border.
class SplineImage {
 public:
  explicit SplineImage(std::shared_ptr<const Image> image);
  /// At pixel coordinates; pixel centres at integers.
  Lookup at(const Eigen::Vector2d& px) const;
  const std::shared_ptr<const Image>& image() const { return image_; }

 private:
  std::shared_ptr<const Image> image_;
  std::vector<double> c_;  ///< spline coefficients, row-major
};

}  // namespace hookeye
