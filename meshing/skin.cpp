#include "meshing/skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "meshing/changing_skin.h"
#include "meshing/soup.h"

namespace hookeye::detail {
namespace {

using Triangle = std::array<int, 3>;

constexpr double kBadAngle = 15.0 * std::numbers::pi / 180.0;  ///< [rad] of a bad triangle
/// Good shapes change for so much wider an angle: within one triangle of the surface, and where the
/// new ones lie on several (regions count by the surface's triangles).
constexpr double kWider = 1.3, kMuchWider = 2.0;

/// Turns and contracts edges where triangles are bad, while that widens the smallest angle.
class Mending {
 public:
  Mending(Subdivided& skin, double tolerance, double longest)
      : skin_(skin), tolerance_(tolerance), longest_(longest) {}

  void run() {
    std::vector<int> open(static_cast<size_t>(skin_.size()));
    std::iota(open.rbegin(), open.rend(), 0);
    // Every change makes the sorted list of angles greater, so this ends.
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      if (skin_.alive(t)) mend(t, open);
    }
    skin_.drop_gone();
  }

 private:
  void turned(int s, int p, int q, SkinChange& best) const {
    std::optional<SkinChange> change = skin_.turned(s, p, q);
    if (!change) return;
    const int a = change->fresh[0][0], b = change->fresh[0][2];
    const Vector3d across = (skin_.at(q) - skin_.at(p)).cross(skin_.at(a) - skin_.at(b));
    const double apart = std::abs((skin_.at(a) - skin_.at(p)).dot(across));  // the edges' distance
    if (apart <= tolerance_ * across.norm()) consider(*change, best);
  }

  void contracted(int u, int v, SkinChange& best) const {
    std::optional<SkinChange> change = skin_.contracted(u, v);
    if (!change) return;
    auto fresh = change->fresh.begin();
    for (const int t : skin_.around(u)) {
      const Triangle old = skin_.corners(t);
      if (std::ranges::find(old, v) != old.end()) continue;
      const Vector3d old_area = skin_.area(old), new_area = skin_.area(*fresh);
      const double larger = std::max(old_area.norm(), new_area.norm());
      if (std::abs(old_area.dot(skin_.at(v) - skin_.at(u))) > tolerance_ * larger) return;
      if (new_area.dot(against(*fresh, v, t)) <= 0.0) return;
      for (const int w : *fresh)
        if ((skin_.at(w) - skin_.at(v)).norm() > longest_) return;
      ++fresh;
    }
    consider(*change, best);
  }

  /// What the normal of a fresh triangle must agree with: the old one's, or, where that has none to
  /// speak of, that of the neighbour on the far side.
  Vector3d against(const Triangle& fresh, int v, int old) const {
    const Vector3d before = skin_.area(skin_.corners(old));
    std::array<int, 2> far{};
    for (size_t i = 0; const int w : fresh)
      if (w != v) far[i++ % 2] = w;
    const double base = (skin_.at(far[0]) - skin_.at(far[1])).norm();
    if (before.norm() > tolerance_ * base || base == 0.0) return before;
    for (const int t : skin_.beside(far[0], far[1]))
      if (t != old) return skin_.area(skin_.corners(t));
    return before;
  }

  void consider(SkinChange& change, SkinChange& best) const {
    const double before = skin_.smallest(change.gone);
    const double wanted = before < kBadAngle         ? 1.001 * before + 1e-9
                          : skin_.one_parent(change) ? kWider * before
                                                     : kMuchWider * before;
    if (change.angle < wanted || change.angle <= best.angle) return;
    if (skin_.stays_near(change, tolerance_)) best = change;
  }

  void mend(int t, std::vector<int>& open) {
    SkinChange best;
    const Triangle corners = skin_.corners(t);
    const bool bad = skin_.angle(corners) < kBadAngle;
    for (size_t k = 0; k < 3; ++k) {
      const int p = corners[k], q = corners[(k + 1) % 3];
      turned(t, p, q, best);
      if (!bad) continue;
      contracted(p, q, best);
      contracted(q, p, best);
    }
    if (!best.gone.empty()) skin_.apply(best, open);
  }

  ChangingSkin skin_;
  double tolerance_;
  double longest_;
};

}  // namespace

Subdivided skin_of(const SurfaceMesh& surface, double longest, double tolerance) {
  Subdivided skin;
  skin.mesh.X = surface.X;
  skin.mesh.triangles = surface.triangles;
  skin.parent.resize(surface.triangles.size());
  std::iota(skin.parent.begin(), skin.parent.end(), 0);
  return skin_of(std::move(skin), longest, tolerance);
}

Subdivided skin_of(Subdivided skin, double longest, double tolerance) {
  constexpr int kRounds = 30;  // far more than were ever needed: then edges are cut alone
  int round = 0;
  do {
    if (round++ < kRounds) Mending(skin, tolerance, longest).run();
  } while (!bisect(skin, longest).empty());
  drop_unused(skin.mesh);  // the mesher would put nodes there
  return skin;
}

}  // namespace hookeye::detail
