#include "meshing/triangle_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace hookeye::detail {

Vector3d closest_weights(const Vector3d& p, const Vector3d& a, const Vector3d& b,
                         const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double v = d1 / (d1 - d3);
    return {1 - v, v, 0};
  }
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return {1 - w, 0, w};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

TriangleTree::TriangleTree(Matrix3Xd X, std::vector<std::array<int, 3>> triangles)
    : X_(std::move(X)), triangles_(std::move(triangles)), boxes_(triangles_.size()) {
  for (size_t t = 0; t < triangles_.size(); ++t) {
    for (int i : triangles_[t]) boxes_[t].extend(Vector3d(X_.col(i)));
  }
  order_.resize(triangles_.size());
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(triangles_.size());
  if (!order_.empty()) build(0, static_cast<int>(order_.size()));
}

int TriangleTree::build(int first, int last) {
  const int index = static_cast<int>(nodes_.size());
  Node node;
  node.first = first;
  node.last = last;
  for (int i = first; i < last; ++i) node.box.extend(boxes_[order_[i]]);
  nodes_.push_back(node);
  if (last - first <= 4) return index;
  int axis = 0;
  node.box.sizes().maxCoeff(&axis);
  const int middle = (first + last) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](int s, int t) {
                     const double a = boxes_[s].center()[axis], b = boxes_[t].center()[axis];
                     return a != b ? a < b : s < t;
                   });
  const int left = build(first, middle);
  const int right = build(middle, last);
  nodes_[index].left = left;
  nodes_[index].right = right;
  return index;
}

Hit TriangleTree::nearest(const Vector3d& p) const {
  Hit best;
  if (nodes_.empty()) return best;
  double best_squared = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, int>> open{{nodes_[0].box.squaredExteriorDistance(p), 0}};
  while (!open.empty()) {
    const auto [bound, index] = open.back();
    open.pop_back();
    if (bound > best_squared) continue;
    const Node& node = nodes_[index];
    if (node.left >= 0) {
      std::pair<double, int> near{nodes_[node.left].box.squaredExteriorDistance(p), node.left};
      std::pair<double, int> far{nodes_[node.right].box.squaredExteriorDistance(p), node.right};
      if (far.first < near.first) std::swap(near, far);
      open.push_back(far);
      open.push_back(near);
      continue;
    }
    for (int i = node.first; i < node.last; ++i) {
      const int t = order_[i];
      const auto& [a, b, c] = triangles_[t];
      const Vector3d w = closest_weights(p, X_.col(a), X_.col(b), X_.col(c));
      const double d = (w[0] * X_.col(a) + w[1] * X_.col(b) + w[2] * X_.col(c) - p).squaredNorm();
      if (d < best_squared || (d == best_squared && t < best.triangle)) {
        best_squared = d;
        best = {t, std::sqrt(d), w};
      }
    }
  }
  return best;
}

std::vector<int> TriangleTree::touching(const Eigen::AlignedBox3d& box) const {
  std::vector<int> found, open;
  if (!nodes_.empty()) open.push_back(0);
  while (!open.empty()) {
    const Node& node = nodes_[open.back()];
    open.pop_back();
    if (!node.box.intersects(box)) continue;
    if (node.left >= 0) {
      open.push_back(node.left);
      open.push_back(node.right);
      continue;
    }
    for (int i = node.first; i < node.last; ++i) {
      if (boxes_[order_[i]].intersects(box)) found.push_back(order_[i]);
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace hookeye::detail
