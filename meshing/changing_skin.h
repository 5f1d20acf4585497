// Edges of a closed triangle surface turned and contracted one by one: what a change would make,
// and making it.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "meshing/subdivide.h"

namespace hookeye::detail {

/// Smallest angle of a triangle [rad].
double smallest_angle(const Vector3d& a, const Vector3d& b, const Vector3d& c);

/// Triangles that go and what comes for them.
struct SkinChange {
  std::vector<int> gone;
  std::vector<std::array<int, 3>> fresh;  ///< no more than those that go
  std::vector<int> left;                  ///< vertices that lie on no triangle's corner any more
  double angle = 0.0;                     ///< smallest of the fresh [rad]
};

/// A surface whose triangles come and go. No vertex is moved. Indices of triangles and vertices
/// stay until drop_gone().
class ChangingSkin {
 public:
  explicit ChangingSkin(Subdivided& skin);

  int size() const { return static_cast<int>(skin_.mesh.triangles.size()); }
  bool alive(int t) const { return alive_[static_cast<size_t>(t)]; }
  const std::array<int, 3>& corners(int t) const {
    return skin_.mesh.triangles[static_cast<size_t>(t)];
  }
  const std::vector<int>& around(int v) const { return around_[static_cast<size_t>(v)]; }
  Vector3d at(int v) const { return skin_.mesh.X.col(v); }
  double angle(const std::array<int, 3>& t) const {
    return smallest_angle(at(t[0]), at(t[1]), at(t[2]));
  }
  /// Normal times twice the area.
  Vector3d area(const std::array<int, 3>& t) const {
    return (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
  }
  /// Triangles that use both vertices.
  std::vector<int> beside(int p, int q) const;
  /// Smallest angle of these triangles [rad].
  double smallest(const std::vector<int>& triangles) const;

  /// The edge from p to q of triangle s replaced by the one between the opposite vertices; none
  /// where the four corners do not allow it.
  std::optional<SkinChange> turned(int s, int p, int q) const;
  /// Vertex u drawn to its neighbour v; none where that would pinch the surface.
  std::optional<SkinChange> contracted(int u, int v) const;

  /// Whether the triangles that go come from one of the input.
  bool one_parent(const SkinChange& change) const;
  /// Whether all vertices that lay on what goes lie within `tolerance` of what comes. Adds those
  /// that were left before to `change.left`.
  bool stays_near(SkinChange& change, double tolerance) const;
  /// Triangles with a corner of a fresh one are appended to `touched`.
  void apply(const SkinChange& change, std::vector<int>& touched);
  void drop_gone();

 private:
  std::pair<size_t, double> nearest(int v, const SkinChange& change) const;

  Subdivided& skin_;
  std::vector<std::vector<int>> around_;  ///< triangles at each vertex
  std::vector<std::vector<int>> left_;    ///< vertices that now lie on each triangle
  std::vector<bool> alive_;
};

}  // namespace hookeye::detail
