#include "estimation/inspection/load_case.h"

#include <algorithm>
#include <cmath>

namespace hookeye::inspection {

namespace {

/// Whether the camera sees the body where its reference photo shows it, as far as that can be told.
bool trusted(Sight& sight, PhotoIndex reference) {
  if (sight.doubted(sight.spec(reference).camera)) return false;
  const Agreement& agreement = sight.agreement(reference);
  return std::isnan(agreement.share) || agreement.share >= sight.options().found_share;
}

bool is_image(const Sight& sight, PhotoIndex photo) {
  return sight.spec(photo).kind == PhotoSpec::Kind::image;
}

}  // namespace

LoadCase load_case(Sight& sight, int e) {
  LoadCase out;
  out.example = e;
  const FirstGuess* guess = sight.guess(e);
  if (!guess || guess->linear.size() == 0) return out;
  for (int k = 0; k < static_cast<int>(sight.example(e).photos.size()); ++k) {
    const PhotoIndex photo{e, k};
    const auto reference = sight.reference(sight.spec(photo).camera);
    if (!reference || reference->first == e || !is_image(sight, photo) ||
        !is_image(sight, *reference) || !trusted(sight, *reference))
      continue;
    Motion motion = seen_motion(sight, photo, *reference);
    if (motion.seen.empty()) continue;
    const FirstGuess& before = *sight.guess(reference->first);
    if (before.linear.size() == 0) continue;
    out.first_order.add(motion.seen,
                        first_order_motion(sight, motion, guess->linear - before.linear));
    if (guess->x.size() > 0 && before.x.size() > 0)
      out.guessed.add(motion.seen, motion_between(sight, motion, before.x, guess->x));
    out.motions.push_back(std::move(motion));
  }
  return out;
}

void remove_mean(std::vector<Vector2d>& seen, std::vector<Vector2d>& expected) {
  Vector2d of_seen = Vector2d::Zero(), of_expected = Vector2d::Zero();
  double count = 0.0;
  for (size_t i = 0; i < seen.size(); ++i)
    if (expected[i].allFinite()) of_seen += seen[i], of_expected += expected[i], count += 1.0;
  for (Vector2d& one : seen) one -= of_seen / std::max(count, 1.0);
  for (Vector2d& one : expected) one -= of_expected / std::max(count, 1.0);
}

MotionSums against(Sight& sight, const LoadCase& seen, const Matrix3Xd& answer, Shift shift) {
  MotionSums sums;
  for (const Motion& motion : seen.motions) {
    const FirstGuess& before = *sight.guess(motion.reference.first);
    std::vector<Vector2d> told = motion.seen;
    std::vector<Vector2d> expected = first_order_motion(sight, motion, answer - before.linear);
    if (shift == Shift::removed) remove_mean(told, expected);
    sums.add(told, expected);
  }
  return sums;
}

bool moved_by_forces(const ExampleSpec& example) {
  const auto& supports = example.supports;
  return std::all_of(supports.begin(), supports.end(), [](const SupportSpec& support) {
    if (support.kind == SupportSpec::Kind::rigid)
      return support.rigid.degrees == 0.0 && support.rigid.move.isZero(0.0);
    return support.kind == SupportSpec::Kind::components &&
           std::all_of(support.displacement.begin(), support.displacement.end(),
                       [](const auto& u) { return u.value_or(0.0) == 0.0; });
  });
}

bool moved_by_unknown(const ExampleSpec& example) {
  const auto& supports = example.supports;
  return std::any_of(supports.begin(), supports.end(), [](const SupportSpec& support) {
    return support.kind == SupportSpec::Kind::rigid_fit;
  });
}

}  // namespace hookeye::inspection
