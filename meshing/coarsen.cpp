#include "meshing/coarsen.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <queue>
#include <set>
#include <tuple>

#include "meshing/changing_skin.h"
#include "meshing/soup.h"
#include "meshing/triangle_tree.h"

namespace hookeye::detail {
namespace {

using Triangle = std::array<int, 3>;

constexpr double kGoodAngle = 12.0 * std::numbers::pi / 180.0;  ///< [rad] that contracting keeps
/// Cosine of 40 degrees between triangles, from which their edge is sharp, as `--repair` has it.
constexpr double kSharp = 0.766;
constexpr double kWider = 1.2;  ///< an edge is turned for so much wider an angle

class Coarsening {
 public:
  Coarsening(Subdivided& skin, const TriangleTree& old, double edge, double tolerance)
      : skin_(skin), old_(old), shortest_(0.6 * edge), tolerance_(tolerance) {}

  void run() {
    for (int t = 0; t < skin_.size(); ++t) enter(t);
    // Slivers keep their neighbours from being contracted until edges between them are turned.
    constexpr int kRounds = 8;
    for (int round = 0; round < kRounds; ++round) {
      contract();
      if (!turn()) break;
    }
    contract();
    skin_.drop_gone();
  }

 private:
  using Edge = std::tuple<double, int, int>;

  void contract() {
    while (!open_.empty()) {
      const auto [length, u, v] = open_.top();
      open_.pop();
      const SkinChange change = best_of(u, v);
      if (!change.gone.empty()) make(change);
    }
  }

  /// Whether any edge was turned.
  bool turn() {
    bool any = false;
    for (int t = 0; t < skin_.size(); ++t) {
      if (!skin_.alive(t)) continue;
      SkinChange best;
      for (size_t k = 0; k < 3; ++k) {
        const int p = skin_.corners(t)[k], q = skin_.corners(t)[(k + 1) % 3];
        if (sharp(p, q)) continue;
        std::optional<SkinChange> change = skin_.turned(t, p, q);
        if (change && change->angle > best.angle &&
            change->angle > kWider * skin_.smallest(change->gone) && faces_along(*change) &&
            stays(*change))
          best = *change;
      }
      if (best.gone.empty()) continue;
      make(best);
      any = true;
    }
    return any;
  }

  void make(const SkinChange& change) {
    std::vector<int> touched;
    skin_.apply(change, touched);
    std::ranges::sort(touched);
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    for (const int t : touched) enter(t);
  }

  /// Whether what comes of a turned edge faces as what goes.
  bool faces_along(const SkinChange& change) const {
    for (const std::array<int, 3>& fresh : change.fresh)
      for (const int t : change.gone)
        if (skin_.area(fresh).dot(skin_.area(skin_.corners(t))) <= 0.0) return false;
    return true;
  }

  void enter(int t) {
    const Triangle& corners = skin_.corners(t);
    for (size_t k = 0; k < 3; ++k) {
      const auto [u, v] = std::minmax(corners[k], corners[(k + 1) % 3]);
      const double length = (skin_.at(u) - skin_.at(v)).norm();
      if (length < shortest_) open_.emplace(length, u, v);
    }
  }

  SkinChange best_of(int u, int v) const {
    SkinChange best;
    for (const auto& [from, to] : {std::pair{u, v}, {v, u}}) {
      std::optional<SkinChange> change = skin_.contracted(from, to);
      if (change && change->angle > best.angle && keeps_shape(*change, from, to)) best = *change;
    }
    return best;
  }

  bool sharp(int u, int v) const {
    const std::vector<int> both = skin_.beside(u, v);
    if (both.size() != 2) return true;
    const Vector3d a = skin_.area(skin_.corners(both[0])), b = skin_.area(skin_.corners(both[1]));
    return a.dot(b) < kSharp * a.norm() * b.norm();
  }

  /// A vertex of a sharp edge goes along it alone; where edges meet or end it stays.
  bool leaves_edges(int u, int v) const {
    std::set<int> neighbours;
    for (const int t : skin_.around(u))
      for (const int w : skin_.corners(t))
        if (w != u) neighbours.insert(w);
    const auto edges = std::ranges::count_if(neighbours, [&](int w) { return sharp(u, w); });
    return edges == 0 || (edges == 2 && sharp(u, v));
  }

  bool keeps_shape(SkinChange& change, int u, int v) const {
    if (!leaves_edges(u, v)) return false;
    if (change.angle < std::min(kGoodAngle, skin_.smallest(change.gone))) return false;
    auto fresh = change.fresh.begin();
    for (const int t : skin_.around(u)) {
      const Triangle& old = skin_.corners(t);
      if (std::ranges::find(old, v) != old.end()) continue;
      if (skin_.area(*fresh).dot(skin_.area(old)) <= 0.0) return false;
      ++fresh;
    }
    return stays(change);
  }

  bool stays(SkinChange& change) const {
    return skin_.stays_near(change, tolerance_) &&
           std::ranges::all_of(change.fresh, [&](const Triangle& t) { return lies_near(t); });
  }

  /// Middles of a new triangle and of its edges: its corners lie on the old surface.
  bool lies_near(const Triangle& t) const {
    const Vector3d a = skin_.at(t[0]), b = skin_.at(t[1]), c = skin_.at(t[2]);
    return std::ranges::all_of(
        std::array<Vector3d, 4>{(a + b + c) / 3.0, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)},
        [&](const Vector3d& x) { return old_.nearest(x).distance <= tolerance_; });
  }

  ChangingSkin skin_;
  const TriangleTree& old_;
  double shortest_, tolerance_;
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> open_;
};

/// Least squares over points of each triangle: how far the old surface is from them, along the
/// triangle's normal. A corner of plane faces moves only within these.
class Balancing {
 public:
  Balancing(SurfaceMesh& surface, const SurfaceMesh& old_surface, const TriangleTree& old,
            double tolerance)
      : surface_(surface), old_surface_(old_surface), old_(old), tolerance_(tolerance) {}

  void run() {
    measure();
    number_unknowns();
    if (unknowns_ == 0) return;
    std::vector<Eigen::Triplet<double>> entries;
    VectorXd right = VectorXd::Zero(unknowns_);
    for (size_t t = 0; t < surface_.triangles.size(); ++t) add(t, entries, right);
    Eigen::SparseMatrix<double> system(unknowns_, unknowns_);
    system.setFromTriplets(entries.begin(), entries.end());
    // Along the surface, and along an edge, triangles hardly ask for anything: little moves there.
    const double kept = 0.1 * system.diagonal().mean();
    for (int i = 0; i < unknowns_; ++i) system.coeffRef(i, i) += kept;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(system);
    if (factor.info() != Eigen::Success) return;
    move(factor.solve(right));
  }

 private:
  /// Barycentric: middles of the ten parts that stand upright, of a triangle cut four times.
  static std::vector<Vector3d> points() {
    std::vector<Vector3d> all;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; i + j < 4; ++j)
        all.push_back(Vector3d(3 * i + 1, 3 * j + 1, 3 * (3 - i - j) + 1) / 12.0);
    return all;
  }

  Vector3d old_point(const Vector3d& x) const {
    const Hit hit = old_.nearest(x);
    const auto& [a, b, c] = old_surface_.triangles[static_cast<size_t>(hit.triangle)];
    return hit.weights[0] * old_surface_.X.col(a) + hit.weights[1] * old_surface_.X.col(b) +
           hit.weights[2] * old_surface_.X.col(c);
  }

  Vector3d corner(const Triangle& t, size_t k) const { return surface_.X.col(t[k]); }

  void measure() {
    for (const Triangle& t : surface_.triangles) {
      const Vector3d a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
      const Vector3d vector = (b - a).cross(c - a);
      normals_.push_back(vector.stableNormalized());
      areas_.push_back(0.5 * vector.norm());
      VectorXd gaps(static_cast<Eigen::Index>(points_.size()));
      for (size_t i = 0; i < points_.size(); ++i) {
        const Vector3d x = points_[i][0] * a + points_[i][1] * b + points_[i][2] * c;
        gaps[static_cast<Eigen::Index>(i)] = (old_point(x) - x).dot(normals_.back());
      }
      gaps_.push_back(std::move(gaps));
    }
  }

  /// Directions in which each vertex may move, as columns.
  void number_unknowns() {
    const double plane = 1e-6 * tolerance_;  // rounding of the coordinates is far below
    const auto n = static_cast<size_t>(surface_.X.cols());
    std::vector<std::vector<Vector3d>> kept(n);
    std::vector<bool> used(n, false);
    for (size_t t = 0; t < surface_.triangles.size(); ++t) {
      for (const int v : surface_.triangles[t]) used[static_cast<size_t>(v)] = true;
      if (gaps_[t].cwiseAbs().maxCoeff() > plane) continue;
      for (const int v : surface_.triangles[t]) {
        Vector3d rest = normals_[t];
        for (const Vector3d& k : kept[static_cast<size_t>(v)]) rest -= k.dot(rest) * k;
        if (rest.norm() > 1e-3) kept[static_cast<size_t>(v)].push_back(rest.normalized());
      }
    }
    for (size_t v = 0; v < n; ++v) {
      first_.push_back(unknowns_);
      Eigen::Matrix3d free = Eigen::Matrix3d::Identity();
      for (const Vector3d& k : kept[v]) free -= k * k.transpose();
      const auto count = used[v] ? 3 - static_cast<int>(kept[v].size()) : 0;
      // projection: its largest eigenvectors span what is free
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> parts(free);
      free_.emplace_back(parts.eigenvectors().rightCols(count));
      unknowns_ += count;
    }
  }

  void add(size_t t, std::vector<Eigen::Triplet<double>>& entries, VectorXd& right) const {
    const Triangle& corners = surface_.triangles[t];
    const double weight = areas_[t] / static_cast<double>(points_.size());
    std::vector<std::pair<int, VectorXd>> parts;  // of the three corners: first unknown, slopes
    for (const int v : corners)
      parts.emplace_back(first_[static_cast<size_t>(v)],
                         free_[static_cast<size_t>(v)].transpose() * normals_[t]);
    for (size_t s = 0; s < points_.size(); ++s) {
      const Vector3d& w = points_[s];
      for (int k = 0; k < 3; ++k) {
        const auto& [row, along] = parts[static_cast<size_t>(k)];
        right.segment(row, along.size()) +=
            weight * w[k] * gaps_[t][static_cast<Eigen::Index>(s)] * along;
        for (int l = 0; l < 3; ++l) {
          const auto& [column, other] = parts[static_cast<size_t>(l)];
          for (Eigen::Index i = 0; i < along.size(); ++i)
            for (Eigen::Index j = 0; j < other.size(); ++j)
              entries.emplace_back(row + i, column + j, weight * w[k] * w[l] * along[i] * other[j]);
        }
      }
    }
  }

  void move(const VectorXd& found) {
    for (size_t v = 0; v < free_.size(); ++v) {
      Vector3d step = free_[v] * found.segment(first_[v], free_[v].cols());
      const double length = step.norm();
      if (length > tolerance_) step *= tolerance_ / length;
      surface_.X.col(static_cast<Eigen::Index>(v)) += step;
    }
  }

  SurfaceMesh& surface_;
  const SurfaceMesh& old_surface_;
  const TriangleTree& old_;
  double tolerance_;
  std::vector<Vector3d> points_ = points();
  std::vector<Vector3d> normals_;
  std::vector<double> areas_;
  std::vector<VectorXd> gaps_;
  std::vector<int> first_;
  std::vector<Eigen::Matrix<double, 3, Eigen::Dynamic>> free_;
  int unknowns_ = 0;
};

}  // namespace

Subdivided coarsened(const SurfaceMesh& surface, double edge, double tolerance) {
  Subdivided skin;
  skin.mesh.X = surface.X;
  skin.mesh.triangles = surface.triangles;
  skin.parent.resize(surface.triangles.size());
  std::iota(skin.parent.begin(), skin.parent.end(), 0);
  const TriangleTree old(surface.X, surface.triangles);
  Coarsening(skin, old, edge, tolerance).run();
  drop_unused(skin.mesh);
  // Linear steps; what a second one leaves is a thousandth of the volume where the first began with
  // a hundredth.
  for (int step = 0; step < 2; ++step) Balancing(skin.mesh, surface, old, tolerance).run();
  std::ranges::fill(skin.parent, kSeveral);
  return skin;
}

}  // namespace hookeye::detail
