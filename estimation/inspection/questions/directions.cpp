// Does the body move where its loads and supports would move it? Where not: has a load or a motion
// the other sign, does a region end where it should not?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "estimation/inspection/load_case.h"
#include "estimation/inspection/load_variants.h"
#include "estimation/inspection/question.h"

namespace hookeye::inspection {

namespace {

bool can_be_told(const LoadCase& seen, const InspectionOptions& options) {
  return seen.first_order.count > 0.0 && seen.first_order.expected_px() > 0.0 &&
         seen.first_order.seen_px() >= options.least_motion_px;
}

double best_cosine(const LoadCase& seen) {
  return std::max(seen.first_order.cosine(),
                  seen.guessed.count > 0.0 ? seen.guessed.cosine() : -1.0);
}

/// What is left of the seen motions once the part along the expected ones is out [px^2].
double left(const MotionSums& sums) {
  const double cosine = std::max(sums.cosine(), 0.0);
  return sums.seen2 * (1.0 - cosine * cosine);
}

/// More goes elsewhere than a camera that was moved between its photos would show.
bool goes_elsewhere(Sight& sight, const LoadCase& seen, const MotionSums& told) {
  const InspectionOptions& options = sight.options();
  return std::sqrt(left(told) / told.count) >= options.sure_astray_px &&
         against(sight, seen, sight.guess(seen.example)->linear, Shift::removed).cosine() <
             options.astray_cosine;
}

/// Signs of loads and motions.
void ask_for_signs(Sight& sight, const LoadCase& seen, Warnings& warnings) {
  const InspectionOptions& options = sight.options();
  const int e = seen.example;
  const MotionSums told = against(sight, seen, sight.guess(e)->linear);
  if (std::max(told.cosine(), best_cosine(seen)) >= options.astray_cosine) return;
  const LoadVariant* best = nullptr;
  double reached = options.sure_cosine;
  const auto all = reversed(*sight.coarse(), e);
  for (const LoadVariant& variant : all) {
    const FirstGuess answer = sight.coarse()->answer(e, variant.loading);
    if (answer.linear.size() == 0) continue;
    const double cosine = against(sight, seen, answer.linear).cosine();
    if (cosine > reached) best = &variant, reached = cosine;
  }
  const std::string what = fmt::format(
      "in the photos of example `{}` the body moves by {:.3g} px, but not where the capture would "
      "move it (cosine {:.2f} of {:.0f} points)",
      sight.example(e).name, told.seen_px(), told.cosine(), told.count);
  if (best) {
    sight.doubt_load(e);
    warnings.say(best->place, fmt::format("{}; it does if {} ({:.2f})", what, best->seen, reached),
                 best->right);
  } else if (goes_elsewhere(sight, seen, told)) {
    sight.doubt_load(e);
    warnings.say(
        sight.example(e).place, what,
        "look at the directions of the loads, which are the world's and not the part's, "
        "at supports and at regions (`check -o DIR` draws them); where the drawing moves as "
        "the photo does the loads may be right");
  }
}

struct Grown {
  LoadVariant variant;
  double told = 0.0, grown = 0.0, seen = 0.0;
};

/// Regions that end within a flat face, though the motions ask for all of it.
void ask_for_regions(Sight& sight, const std::map<int, LoadCase>& cases, Warnings& warnings) {
  const InspectionOptions& options = sight.options();
  std::map<int, Grown> by_line;  // a region's place
  for (const auto& [e, seen] : cases) {
    if (seen.motions.empty() || sight.load_doubted(e)) continue;
    for (const LoadVariant& variant :
         grown(*sight.coarse(), e, options.flat_cosine, options.most_of_face)) {
      const FirstGuess answer = sight.coarse()->answer(e, variant.loading);
      if (answer.linear.size() == 0) continue;
      Grown& sum = by_line.try_emplace(variant.place.line, Grown{variant}).first->second;
      const MotionSums now = against(sight, seen, sight.guess(e)->linear);
      sum.told += left(now), sum.seen += now.seen2;
      sum.grown += left(against(sight, seen, answer.linear));
    }
  }
  for (const auto& [line, sum] : by_line) {
    if (sum.told < options.left_of_motion * sum.seen ||
        sum.grown > options.left_by_grown * sum.told)
      continue;
    warnings.say(
        sum.variant.place,
        fmt::format("{:.0f} % of the squares of the motions that the photos show are not where "
                    "the capture would move the body, but {:.1f} % if {}",
                    100.0 * sum.told / sum.seen, 100.0 * sum.grown / sum.seen, sum.variant.seen),
        sum.variant.right);
  }
}

}  // namespace

void ask_directions(Sight& sight, Warnings& warnings) {
  std::map<int, LoadCase> cases;
  for (size_t e = 0; e < sight.scene().capture.examples.size(); ++e) {
    const LoadCase& seen = sight.load_case(static_cast<int>(e));
    if (can_be_told(seen, sight.options())) cases.emplace(seen.example, seen);
  }
  for (const auto& [e, seen] : cases)
    if (!sight.load_doubted(e)) ask_for_signs(sight, seen, warnings);
  ask_for_regions(sight, cases, warnings);
}

}  // namespace hookeye::inspection
