#include "estimation/images/brightness.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace hookeye {

namespace {

/// Neighbouring nodes are held together as by this many pixels, so that one that hardly any lies by
/// has a gain: a hundredth of what lies by a node within the body. And to 1, by next to nothing.
constexpr double kTogether = 8.0, kToOne = 1e-3;

int root_of(std::vector<int>& parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

std::vector<int> smooth_patches(const SurfaceMesh& surface, double degrees) {
  const auto count = static_cast<int>(surface.triangles.size());
  std::vector<Vector3d> normal(count);
  for (int t = 0; t < count; ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    normal[t] = (surface.X.col(b) - surface.X.col(a))
                    .cross(surface.X.col(c) - surface.X.col(a))
                    .normalized();
  }
  std::vector<int> patch(count);
  std::iota(patch.begin(), patch.end(), 0);
  const double flat = std::cos(degrees * M_PI / 180.0);
  std::map<std::pair<int, int>, int> seen;  // edge -> triangle
  for (int t = 0; t < count; ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = surface.triangles[t][k], b = surface.triangles[t][(k + 1) % 3];
      const auto [at, first] = seen.try_emplace(std::minmax(a, b), t);
      if (first || normal[t].dot(normal[at->second]) < flat) continue;
      patch[root_of(patch, t)] = root_of(patch, at->second);
    }
  std::map<int, int> number;
  std::vector<int> out(count);
  for (int t = 0; t < count; ++t)
    out[t] = number.try_emplace(root_of(patch, t), static_cast<int>(number.size())).first->second;
  return out;
}

Brightness::Brightness(const Rendering& picture, const Image& photo,
                       const std::vector<unsigned char>& valid,
                       const std::vector<int>& patch_of_triangle, double cell)
    : I_(picture.I),
      cell_(cell),
      patch_(I_.pixels(), -1),
      gain_(I_.pixels(), 1.0f),
      lattices_(patch_of_triangle.empty()
                    ? 0
                    : 1 + *std::max_element(patch_of_triangle.begin(), patch_of_triangle.end())) {
  double level = 0.0, count = 0.0;
  for (size_t i = 0; i < patch_.size(); ++i) {
    const int triangle = picture.triangle[i];
    if (triangle < 0 || picture.coverage.values[i] <= 1.0f - 1e-6f) continue;
    if (!valid.empty() && !valid[i]) continue;
    patch_[i] = patch_of_triangle[triangle];
    level += photo.values[i], ++count;
  }
  if (!(level > 0.0)) {
    std::fill(patch_.begin(), patch_.end(), -1);
    return;
  }
  gain_of_node_.resize(lay_lattices());
  balance(photo, level / count);
  for_each([&](size_t i, const std::array<Corner, 4>& at) {
    gain_[i] = 0.0f;
    for (const Corner& c : at) gain_[i] += c.weight * static_cast<float>(gain_of_node_[c.node]);
  });
}

int Brightness::lay_lattices() {
  constexpr int kMost = std::numeric_limits<int>::max();
  for (Lattice& one : lattices_) one = {kMost, kMost, -1, -1, 0};
  for (size_t i = 0; i < patch_.size(); ++i) {
    if (patch_[i] < 0) continue;
    Lattice& one = lattices_[patch_[i]];
    const int x = static_cast<int>(double(i % I_.width) / cell_);
    const int y = static_cast<int>(double(i / I_.width) / cell_);
    one = {std::min(one.x0, x), std::min(one.y0, y), std::max(one.x1, x + 1),
           std::max(one.y1, y + 1), 0};
  }
  int nodes = 0;
  for (Lattice& one : lattices_) {
    one.first = nodes;
    if (one.x1 >= 0) nodes += one.width() * (one.y1 - one.y0 + 1);
  }
  return nodes;
}

/// Gains of the nodes: M gain = sums of the photo.
void Brightness::balance(const Image& photo, double level) {
  const auto nodes = gain_of_node_.size();
  std::vector<Eigen::Triplet<double>> M;
  const auto add = [&](int a, int b, double value) { M.emplace_back(a, b, value); };
  for (int n = 0; n < nodes; ++n) add(n, n, kToOne * level);
  for (const Lattice& one : lattices_)
    for (int y = one.y0; y <= one.y1; ++y)
      for (int x = one.x0; x <= one.x1; ++x) {
        const int n = one.first + (y - one.y0) * one.width() + x - one.x0;
        for (const int other : {x < one.x1 ? n + 1 : n, y < one.y1 ? n + one.width() : n}) {
          if (other == n) continue;
          for (const auto& [a, b] : {std::pair(n, other), std::pair(other, n)})
            add(a, a, kTogether * level), add(a, b, -kTogether * level);
        }
      }
  Eigen::VectorXd of_photo = Eigen::VectorXd::Constant(nodes, kToOne * level);
  Products products(nodes);
  for_each([&](size_t i, const std::array<Corner, 4>& at) {
    products.add(at, I_.values[i]);
    for (const Corner& c : at) of_photo[c.node] += double(c.weight) * photo.values[i];
  });
  products.for_each(add);
  Eigen::SparseMatrix<double> matrix(nodes, nodes);
  matrix.setFromTriplets(M.begin(), M.end());
  solver_ = std::make_shared<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>>(matrix);
  gain_of_node_ = solver_->solve(of_photo);
}

std::array<Brightness::Corner, 4> Brightness::corners(size_t pixel) const {
  const Lattice& lattice = lattices_[patch_[pixel]];
  const double x = double(pixel % I_.width) / cell_, y = double(pixel / I_.width) / cell_;
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const auto right = static_cast<float>(x - left), below = static_cast<float>(y - top);
  const int width = lattice.width();
  const int node = lattice.first + (top - lattice.y0) * width + left - lattice.x0;
  return {{{node, (1.0f - right) * (1.0f - below)},
           {node + 1, right * (1.0f - below)},
           {node + width, (1.0f - right) * below},
           {node + width + 1, right * below}}};
}

template <class F>
void Brightness::for_each(const F& f) const {
  for (size_t i = 0; i < patch_.size(); ++i)
    if (patch_[i] >= 0) f(i, corners(i));
}

Image Brightness::followed() const {
  Image out = I_;
  for (size_t i = 0; i < gain_.size(); ++i) out.values[i] *= gain_[i];
  return out;
}

Image Brightness::adjoint(const Image& v) const {
  if (nodes() == 0) return v;
  Eigen::VectorXd about = Eigen::VectorXd::Zero(nodes());
  for_each([&](size_t i, const std::array<Corner, 4>& at) {
    for (const Corner& c : at) about[c.node] += double(c.weight) * I_.values[i] * v.values[i];
  });
  about = solver_->solve(about);
  Image out = v;
  for_each([&](size_t i, const std::array<Corner, 4>& at) {
    double back = 0.0;
    for (const Corner& c : at) back += c.weight * about[c.node];
    out.values[i] = static_cast<float>(gain_[i] * (double(v.values[i]) - back));
  });
  return out;
}

void Brightness::Products::add(const std::array<Corner, 4>& at, double weight) {
  for (const Corner& a : at)
    for (const Corner& b : at) {
      Row& row = rows_[a.node];
      int k = 0;
      while (k < row.count && row.entry[k].first != b.node) ++k;
      if (k == row.count) row.entry[row.count++] = {b.node, 0.0};
      row.entry[k].second += weight * a.weight * b.weight;
    }
}

}  // namespace hookeye
