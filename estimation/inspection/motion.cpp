#include "estimation/inspection/motion.h"

#include <algorithm>
#include <cmath>

#include "estimation/evaluation/evaluation.h"
#include "meshing/extent.h"

namespace hookeye::inspection {

Motion seen_motion(Sight& sight, PhotoIndex photo, PhotoIndex reference) {
  Motion motion;
  motion.photo = photo, motion.reference = reference;
  const SmallPhoto &from = sight.small(reference), &to = sight.small(photo);
  const SoughtInReference& sought = sight.sought(reference);
  const BodyPicture& look = sought.look;
  const bool alike = from.I->width == to.I->width && from.I->height == to.I->height;
  const PatchField field = alike ? sought.patches.in(to.I) : PatchField{};
  motion.sought = static_cast<int>(field.patches.size());
  if (field.found() < sight.options().least_patches) return motion;
  for (const Patch& patch : field.patches) {
    const auto pixel = static_cast<size_t>(patch.at.y()) * static_cast<size_t>(from.I->width) +
                       static_cast<size_t>(patch.at.x());
    if (!patch.found || look.triangle[pixel] < 0) continue;
    motion.pixel.push_back(static_cast<int>(pixel));
    motion.triangle.push_back(look.triangle[pixel]);
    motion.uv.push_back(look.uv[pixel]);
    motion.seen.push_back(from.px() * patch.shift);
  }
  return motion;
}

std::vector<Vector2d> motion_between(const Sight& sight, const Motion& motion,
                                     const Matrix3Xd& from, const Matrix3Xd& to) {
  const SurfaceMesh& surface = sight.scene().body->surface.mesh;
  const Camera camera = sight.camera(motion.reference);
  const double px = std::exp2(sight.scene().halvings_of(camera.name));  // of the file
  std::vector<Vector2d> out;
  for (size_t i = 0; i < motion.triangle.size(); ++i)
    out.push_back(px * (place_of(camera, surface, to, motion.triangle[i], motion.uv[i]) -
                        place_of(camera, surface, from, motion.triangle[i], motion.uv[i])));
  return out;
}

std::vector<Vector2d> first_order_motion(const Sight& sight, const Motion& motion,
                                         const Matrix3Xd& u) {
  const Matrix3Xd& rest = sight.scene().body->surface.mesh.X;
  const double size = extent(rest);
  const double largest = u.colwise().norm().maxCoeff();
  if (!(largest > 0.0)) return std::vector<Vector2d>(motion.triangle.size(), Vector2d::Zero());
  const double step = 1e-4 * size / largest;
  auto out = motion_between(sight, motion, rest, rest + step * u);
  for (Vector2d& px : out) px /= step;
  return out;
}

void MotionSums::add(const std::vector<Vector2d>& seen, const std::vector<Vector2d>& expected) {
  for (size_t i = 0; i < seen.size(); ++i) {
    if (!expected[i].allFinite()) continue;
    seen2 += seen[i].squaredNorm(), expected2 += expected[i].squaredNorm();
    both += seen[i].dot(expected[i]), count += 1.0;
  }
}

double MotionSums::seen_px() const { return count > 0.0 ? std::sqrt(seen2 / count) : 0.0; }
double MotionSums::expected_px() const { return count > 0.0 ? std::sqrt(expected2 / count) : 0.0; }
double MotionSums::cosine() const {
  return seen2 > 0.0 && expected2 > 0.0 ? both / std::sqrt(seen2 * expected2) : 0.0;
}

}  // namespace hookeye::inspection
