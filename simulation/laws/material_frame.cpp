#include "simulation/laws/material_frame.h"

#include <fmt/format.h>

#include <Eigen/Dense>

namespace hookeye::laws {
namespace {

Eigen::Vector3d three(const MaterialSpec::Value& value, const std::string& what,
                      const std::string& right) {
  if (value.numbers.size() != 3)
    throw InputError(value.place, fmt::format("{} has {} numbers", what, value.numbers.size()),
                     right);
  return Eigen::Map<const Eigen::Vector3d>(value.numbers.data());
}

}  // namespace

Matrix3d read_frame(const MaterialSpec::Value& rows) {
  if (rows.numbers.size() != 9)
    throw InputError(rows.place, fmt::format("`frame` has {} numbers", rows.numbers.size()),
                     "three rows: the axes 1, 2, 3 in rest coordinates");
  const Matrix3d told = Eigen::Map<const Matrix3d>(rows.numbers.data());  // rows become columns
  if (!((told.transpose() * told - Matrix3d::Identity()).norm() < 3e-4))
    throw InputError(rows.place, "the material frame is not orthonormal",
                     "three unit vectors at right angles, one a row");
  if (told.isIdentity(0.0)) return told;
  const Eigen::JacobiSVD<Matrix3d> svd(told, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

CylinderFrame read_cylinder(const MaterialSpec::Value& axis, const MaterialSpec::Value& center) {
  CylinderFrame out{three(axis, "`frame.axis`", "a direction: [0, 0, 1]"),
                    three(center, "`frame.center`", "a point on the axis: [0, 0, 0]")};
  if (!(out.axis.norm() > 0))
    throw InputError(axis.place, "the axis of the frame has no length", "a direction: [0, 0, 1]");
  out.axis.normalize();
  return out;
}

}  // namespace hookeye::laws
