// One face of the boundary and how to integrate over it.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "meshing/tet_mesh.h"

namespace hookeye::detail {

inline constexpr int kCuts = 16;  ///< a cut face is divided kCuts x kCuts

/// Shape functions of a boundary triangle (corners, then mids of 01 12 20) at weights L.
inline VectorXd face_shape(int order, const Vector3d& L) {
  if (order == 1) return L;
  VectorXd N(6);
  N << L[0] * (2 * L[0] - 1), L[1] * (2 * L[1] - 1), L[2] * (2 * L[2] - 1), 4 * L[0] * L[1],
      4 * L[1] * L[2], 4 * L[2] * L[0];
  return N;
}

/// A boundary face: positions and area vectors at weights L.
class BoundaryFace {
 public:
  BoundaryFace(const TetMesh& mesh, int index)
      : order_(mesh.order), nodes_(mesh.boundary.col(index)) {
    x_.resize(3, nodes_.size());
    for (Eigen::Index k = 0; k < nodes_.size(); ++k) x_.col(k) = mesh.X.col(nodes_[k]);
    half_cross_ = 0.5 * Vector3d(x_.col(1) - x_.col(0)).cross(Vector3d(x_.col(2) - x_.col(0)));
    if (order_ == 2) {
      for (int k = 0; k < 3; ++k) {
        const Vector3d bow = x_.col(3 + k) - 0.5 * (x_.col(k) + x_.col((k + 1) % 3));
        straight_ = straight_ && bow.squaredNorm() <= 1e-18 * half_cross_.norm();
      }
    }
  }
  const Eigen::VectorXi& nodes() const { return nodes_; }
  /// Holds the face, with room for rounding and for what a curved face bulges past its nodes.
  Eigen::AlignedBox3d box() const {
    Eigen::AlignedBox3d box;
    for (Eigen::Index k = 0; k < x_.cols(); ++k) box.extend(Vector3d(x_.col(k)));
    const double room = (straight_ ? 1e-6 : 0.5) * box.diagonal().norm();
    return {box.min().array() - room, box.max().array() + room};
  }
  bool straight() const { return straight_; }
  Vector3d at(const Vector3d& L) const { return x_ * face_shape(order_, L); }
  VectorXd shape(const Vector3d& L) const { return face_shape(order_, L); }
  /// Area vector per unit of reference area (the reference triangle having area 1).
  Vector3d area_vector(const Vector3d& L) const {
    if (straight_) return half_cross_;
    Eigen::Matrix<double, 6, 3> dN = Eigen::Matrix<double, 6, 3>::Zero();
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      dN(i, i) = 4 * L[i] - 1;
      dN(3 + i, i) = 4 * L[j];
      dN(3 + i, j) = 4 * L[i];
    }
    const Eigen::Matrix3d d = x_ * dN;
    return 0.5 * Vector3d(d.col(1) - d.col(0)).cross(Vector3d(d.col(2) - d.col(0)));
  }

 private:
  int order_;
  Eigen::VectorXi nodes_;
  Matrix3Xd x_;
  Vector3d half_cross_;
  bool straight_ = true;
};

struct Sample {
  Vector3d L;
  double weight;  ///< all sum to 1
};

/// Seven-point rule of degree 5 (Radon 1948), for whole faces.
inline const std::vector<Sample>& whole_rule() {
  static const std::vector<Sample> rule = [] {
    const double root = std::sqrt(15.0);
    std::vector<Sample> r{{Vector3d::Constant(1.0 / 3.0), 0.225}};
    for (const double sign : {-1.0, 1.0}) {
      const double a = (6.0 + sign * root) / 21.0, w = (155.0 + sign * root) / 1200.0;
      for (int k = 0; k < 3; ++k) {
        Vector3d L = Vector3d::Constant(a);
        L[k] = 1.0 - 2.0 * a;
        r.push_back({L, w});
      }
    }
    return r;
  }();
  return rule;
}

/// Centroids of the kCuts^2 equal parts of a triangle.
inline const std::vector<Sample>& cut_rule() {
  static const std::vector<Sample> rule = [] {
    std::vector<Sample> r;
    for (int i = 0; i < kCuts; ++i) {
      for (int j = 0; i + j < kCuts; ++j) {
        for (const int up : {1, 2}) {  // the part pointing up, and down
          if (up == 2 && i + j + 2 > kCuts) continue;
          const Vector3d L((i + up / 3.0) / kCuts, (j + up / 3.0) / kCuts,
                           (kCuts - i - j - 2.0 * up / 3.0) / kCuts);
          r.push_back({L, 1.0 / (kCuts * kCuts)});
        }
      }
    }
    return r;
  }();
  return rule;
}

}  // namespace hookeye::detail
