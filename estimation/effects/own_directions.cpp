#include "estimation/effects/own_directions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>

#include "estimation/effects/toolbox.h"

namespace hookeye {

namespace {

using Eigen::Matrix3d;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// Principal moments nearer than that, over the largest, are one: a mesh of a square block's faces
/// tells them apart by rounding, and of a round one's by its facets.
constexpr double kOneMoment = 1e-3;

/// Integral of (X - centre)(X - centre)^T over the volume, of the corners' tetrahedra.
Matrix3d second_moments(const TetMesh& mesh) {
  const VectorXd volumes = element_volumes(mesh);
  const Vector3d centre = element_centres(mesh) * volumes / volumes.sum();
  Matrix3d out = Matrix3d::Zero();
  for (int e = 0; e < mesh.size(); ++e) {
    Vector3d sum = Vector3d::Zero();
    Matrix3d squares = Matrix3d::Zero();
    for (int a = 0; a < 4; ++a) {
      const Vector3d x = mesh.X.col(mesh.elements(a, e)) - centre;
      sum += x;
      squares += x * x.transpose();
    }
    out += volumes[e] / 20.0 * (squares + sum * sum.transpose());
  }
  return out;
}

Matrix3d principal_axes(const TetMesh& mesh) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(second_moments(mesh));
  const Vector3d moments = eigen.eigenvalues();
  const auto one = [&](int i) { return moments[i + 1] - moments[i] < kOneMoment * moments[2]; };
  if (one(0) && one(1)) return Matrix3d::Identity();
  if (!one(0) && !one(1)) return eigen.eigenvectors();
  const Vector3d axis = eigen.eigenvectors().col(one(0) ? 2 : 0);
  Eigen::Index nearest = 0;
  axis.cwiseAbs().minCoeff(&nearest);
  Matrix3d out;
  out.col(0) = axis;
  out.col(1) = (Vector3d::Unit(nearest) - axis[nearest] * axis).normalized();
  out.col(2) = out.col(0).cross(out.col(1));
  return out;
}

/// Integral of (n n^T)(n n^T) over the surface, both as columns of nine.
Matrix9d fourth_moments_of_normals(const TetMesh& mesh) {
  Matrix9d out = Matrix9d::Zero();
  for (Eigen::Index f = 0; f < mesh.boundary.cols(); ++f) {
    const Vector3d a = mesh.X.col(mesh.boundary(0, f));
    const Vector3d normal =
        (mesh.X.col(mesh.boundary(1, f)) - a).cross(Vector3d(mesh.X.col(mesh.boundary(2, f)) - a));
    const double twice = normal.norm();
    if (!(twice > 0.0)) continue;
    const Matrix3d square = normal * normal.transpose() / (twice * twice);
    out += twice * square.reshaped() * square.reshaped().transpose();
  }
  return out / out.trace();
}

/// The sum of A (n.axis)^4 is convex in the axes: each step to the rotation that is nearest to its
/// gradient (polar decomposition) makes it larger, and ends in the maximum next to the start.
Matrix3d towards_normals(const TetMesh& mesh, Matrix3d axes) {
  constexpr int kSteps = 2000;  // of a body that is nearly round; a block takes some ten
  const Matrix9d moments = fourth_moments_of_normals(mesh);
  for (int step = 0; step < kSteps; ++step) {
    Matrix3d gradient;
    for (int k = 0; k < 3; ++k) {
      const Vector3d axis = axes.col(k);
      const Matrix3d square = axis * axis.transpose();
      const Eigen::Matrix<double, 9, 1> product = moments * square.reshaped();
      gradient.col(k) = product.reshaped(3, 3) * axis;
    }
    const Eigen::JacobiSVD<Matrix3d> svd(gradient, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Matrix3d next = svd.matrixU() * svd.matrixV().transpose();
    const double moved = (next - axes).norm();
    axes = next;
    if (moved < 1e-13) break;
  }
  return axes;
}

/// For readers: in the order and on the side of the frame's axes that they are nearest to.
Matrix3d as_in_frame(Matrix3d axes) {
  Matrix3d out;
  Matrix3d left = axes.cwiseAbs();
  for (int i = 0; i < 3; ++i) {
    Eigen::Index along = 0, axis = 0;
    left.maxCoeff(&along, &axis);
    out.col(along) = axes(along, axis) < 0.0 ? Vector3d(-axes.col(axis)) : axes.col(axis);
    left.row(along).setConstant(-1.0);
    left.col(axis).setConstant(-1.0);
  }
  return out;
}

}  // namespace

Matrix3d own_axes(const TetMesh& mesh) {
  return as_in_frame(towards_normals(mesh, principal_axes(mesh)));
}

std::vector<Vector3d> spread_lines() {
  std::vector<Vector3d> all;
  for (Vector3d first :
       {Vector3d(1, 0, 0), Vector3d(1, 1, 0), Vector3d(1, 1, 1), Vector3d(3, 1, 1)}) {
    do {
      for (int signs = 0; signs < 8; ++signs) {
        Vector3d line = first;
        for (int i = 0; i < 3; ++i)
          if (signs >> i & 1) line[i] = -line[i];
        line = line.normalized() + Vector3d::Zero();  // no -0
        const auto is_line = [&](const Vector3d& other) {
          return std::abs(other.dot(line)) > 1.0 - 1e-9;
        };
        if (std::none_of(all.begin(), all.end(), is_line)) all.push_back(line);
      }
    } while (std::prev_permutation(first.begin(), first.end()));
  }
  return all;
}

std::vector<Vector3d> own_lines(const TetMesh& mesh) {
  const Matrix3d axes = own_axes(mesh);
  std::vector<Vector3d> all;
  for (const Vector3d& line : spread_lines()) all.push_back(rounded(axes * line, 0.02));
  return all;
}

std::string direction_text(const Vector3d& direction) {
  const auto as_read = [&](int digits) {
    const std::vector<double> read = numbers_in(vector_text(direction, digits));
    return Vector3d(read.at(0), read.at(1), read.at(2));
  };
  // Rounding beyond five digits is no reason to tell five, nor to tell a zero's sign.
  const Vector3d three = as_read(3), five = as_read(5);
  return three == five ? vector_text(three, 3) : vector_text(five, 5);
}

}  // namespace hookeye
