// Does a photo show another load case? Each photo's motion is held against what the first guess
// expects of every load case of its camera. Told are photos that stand in one another's places, and
// a photo that shows another example's motion. Measured fields are held against the load cases
// alike.
#include "estimation/inspection/exchanges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

#include "estimation/inspection/field_motion.h"
#include "estimation/inspection/load_case.h"
#include "estimation/inspection/question.h"
#include "estimation/model/field_points.h"

namespace hookeye::inspection {

namespace {

/// The photos of one camera whose motions can be told.
using PhotoSeries = std::vector<const Motion*>;

std::map<std::string, PhotoSeries> series_by_camera(Sight& sight) {
  std::map<std::string, PhotoSeries> out;
  for (size_t i = 0; i < sight.scene().capture.examples.size(); ++i) {
    const int e = static_cast<int>(i);
    if (moved_by_unknown(sight.example(e))) continue;
    for (const Motion& motion : sight.load_case(e).motions)
      out[sight.spec(motion.photo).camera].push_back(&motion);
  }
  return out;
}

/// What the first guess expects of the points of one camera's motions in each load case. All
/// motions are of the same points, each without those that are not found in its photo: what is
/// expected of them is worked out once a load case, and looked up for every photo.
class Expectations {
 public:
  Expectations(Sight& sight, const PhotoSeries& series) : sight_(sight) {
    all_.reference = series.front()->reference;
    for (const Motion* motion : series)
      for (size_t i = 0; i < motion->pixel.size(); ++i) {
        if (!place_.emplace(motion->pixel[i], all_.pixel.size()).second) continue;
        all_.pixel.push_back(motion->pixel[i]);
        all_.triangle.push_back(motion->triangle[i]);
        all_.uv.push_back(motion->uv[i]);
      }
  }

  /// Of the points of `motion`, as the first guess expects them of example `e`.
  std::vector<Vector2d> of(const Motion& motion, int e, bool in_equilibrium) {
    auto& known = known_[{e, in_equilibrium}];
    if (known.empty()) known = of_all(e, in_equilibrium);
    std::vector<Vector2d> out;
    out.reserve(motion.pixel.size());
    for (const int pixel : motion.pixel) out.push_back(known[place_.at(pixel)]);
    return out;
  }

 private:
  std::vector<Vector2d> of_all(int e, bool in_equilibrium) {
    const FirstGuess &guess = *sight_.guess(e), &before = *sight_.guess(all_.reference.first);
    return in_equilibrium ? motion_between(sight_, all_, before.x, guess.x)
                          : first_order_motion(sight_, all_, guess.linear - before.linear);
  }

  Sight& sight_;
  Motion all_;                             ///< every point of the series once
  std::unordered_map<int, size_t> place_;  ///< by pixel: its place there
  std::map<std::pair<int, bool>, std::vector<Vector2d>> known_;
};

/// Nothing is compared with an equilibrium unless all have one.
bool have_equilibria(Sight& sight, const PhotoSeries& series) {
  return std::all_of(series.begin(), series.end(), [&](const Motion* motion) {
    return sight.guess(motion->photo.first)->x.size() > 0 &&
           sight.guess(motion->reference.first)->x.size() > 0;
  });
}

/// All photos of a camera against all its load cases, with and without each photo's mean motion,
/// which a camera that was moved has, too.
std::vector<ComparedWays> compared(Sight& sight, Expectations& expected,
                                   const PhotoSeries& series) {
  std::vector<ComparedWays> aspects(2);
  const bool equilibria = have_equilibria(sight, series);
  for (ComparedWays& aspect : aspects)
    aspect.ways.assign(equilibria ? 2 : 1, ComparedPlaces(series.size()));
  for (const Motion* motion : series) {
    for (ComparedWays& aspect : aspects)
      aspect.scaled.push_back(moved_by_forces(sight.example(motion->photo.first)));
    const size_t row = aspects.front().scaled.size() - 1;
    for (const Motion* other : series)
      for (size_t way = 0; way < aspects.front().ways.size(); ++way) {
        auto seen = motion->seen, told = expected.of(*motion, other->photo.first, way == 1);
        for (ComparedWays& aspect : aspects) {
          if (&aspect == &aspects.back()) remove_mean(seen, told);
          aspect.ways[way][row].emplace_back().add(seen, told);
        }
      }
  }
  return aspects;
}

/// Of all photos of an exchange something has to be seen.
bool moves(const Exchange& one, const PhotoSeries& series, const InspectionOptions& options) {
  MotionSums sums;
  for (const int place : one.places) {
    const auto& seen = series[static_cast<size_t>(place)]->seen;
    sums.add(seen, seen);
  }
  return sums.seen_px() >= options.least_motion_px;
}

std::string file_of(const Sight& sight, PhotoIndex photo) {
  return sight.spec(photo).file.lexically_relative(sight.scene().capture.folder).string();
}

void say_exchange(Sight& sight, const Exchange& one, const PhotoSeries& series,
                  Warnings& warnings) {
  std::string which, files;
  for (size_t i = 0; i < one.places.size(); ++i) {
    const PhotoIndex photo = series[static_cast<size_t>(one.places[i])]->photo;
    const PhotoIndex shown = series[static_cast<size_t>(one.fits[i])]->photo;
    which += fmt::format("{}{} shows the motion of example `{}`",
                         i == 0                       ? "photo "
                         : i + 1 == one.places.size() ? ", and photo "
                                                      : ", photo ",
                         sight.told(photo), sight.example(shown.first).name);
    files += fmt::format("{}`{}`: {}", i == 0 ? "" : ", ", sight.example(shown.first).name,
                         file_of(sight, photo));
    sight.doubt_load(photo.first);
  }
  warnings.say(
      sight.spec(series[static_cast<size_t>(one.places.front())]->photo).place,
      fmt::format("{}: of the squares of their motions {:.0f} % are not as the first guess expects "
                  "them, and {:.2g} % once they are exchanged",
                  which, 100.0 * one.told, 100.0 * one.exchanged),
      fmt::format("photos of camera `{}`: {}",
                  sight.spec(series[static_cast<size_t>(one.places.front())]->photo).camera,
                  files));
}

/// One photo alone, to first order.
double cosine(Expectations& expected, const Motion& motion, int example) {
  MotionSums sums;
  sums.add(motion.seen, expected.of(motion, example, false));
  return sums.cosine();
}

/// A photo that does not show its example's motion but that of another, which the camera's photo of
/// that other example does not show either: one of a longer mix-up.
void ask_of_single_photos(Sight& sight, Expectations& expected, const PhotoSeries& series,
                          Warnings& warnings) {
  const InspectionOptions& options = sight.options();
  PhotoSeries clear;
  for (const Motion* motion : series) {
    const MotionSums& sums = sight.load_case(motion->photo.first).first_order;
    if (!sight.load_doubted(motion->photo.first) && sums.expected_px() > 0.0 &&
        sums.seen_px() >= options.least_motion_px)
      clear.push_back(motion);
  }
  std::vector<std::vector<double>> cosines;
  for (const Motion* motion : clear) {
    cosines.emplace_back();
    for (const Motion* other : clear)
      cosines.back().push_back(cosine(expected, *motion, other->photo.first));
  }
  for (size_t i = 0; i < clear.size(); ++i) {
    const auto best = static_cast<size_t>(std::max_element(cosines[i].begin(), cosines[i].end()) -
                                          cosines[i].begin());
    if (cosines[i][i] >= options.astray_cosine || cosines[i][best] < options.sure_cosine ||
        cosines[best][best] >= options.astray_cosine)
      continue;
    const PhotoIndex photo = clear[i]->photo;
    sight.doubt_load(photo.first);
    warnings.say(
        sight.spec(photo).place,
        fmt::format("photo {} shows the motion of example `{}` (cosine {:.2f} with its first "
                    "guess, {:.2f} with that of its own example)",
                    sight.told(photo), sight.example(clear[best]->photo.first).name,
                    cosines[i][best], cosines[i][i]),
        "the photos of several examples stand in one another's places");
  }
}

/// One field of each example that has so many of them, as those of one camera pair: of
/// displacements, or of strains.
struct FieldSeries {
  std::vector<int> examples;
  std::vector<int> starts;  ///< -1: the body as it was given
  std::vector<const MeasuredSpec*> fields;
};

/// A field whose motion the first guess knows, in size but for the stiffness.
bool has_expected_motion(Sight& sight, int start, int e, bool strain) {
  const VectorXd u = guessed_motion(sight, start, e).first_order;
  if (u.size() == 0 || u.isZero(0)) return false;
  // To first order a turn strains.
  const auto unknown = [&](int load) {
    return moved_by_unknown(sight.example(load)) || (strain && sight.guess(load)->turned);
  };
  return !unknown(e) && (start < 0 || !unknown(start));
}

std::vector<FieldSeries> series_of_fields(Sight& sight, bool strains) {
  std::vector<FieldSeries> out;
  for (size_t i = 0; i < sight.scene().capture.examples.size(); ++i) {
    const int e = static_cast<int>(i);
    size_t n = 0;
    for (const MeasuredSpec& measured : sight.example(e).measured) {
      if (!measured.field || is_strain_field(measured) != strains) continue;
      const int start = start_index(sight.scene(), measured);
      const size_t at = n++;
      if (!has_expected_motion(sight, start, e, strains)) continue;
      if (out.size() <= at) out.resize(at + 1);
      out[at].examples.push_back(e), out[at].starts.push_back(start);
      out[at].fields.push_back(&measured);
    }
  }
  return out;
}

MotionSums field_sums(const VectorXd& seen, const VectorXd& expected) {
  MotionSums sums;
  sums.seen2 = seen.squaredNorm(), sums.expected2 = expected.squaredNorm();
  sums.both = seen.dot(expected), sums.count = static_cast<double>(seen.size());
  return sums;
}

ComparedWays compared_fields(Sight& sight, const FieldSeries& series) {
  ComparedWays out;
  bool equilibria = !is_strain_field(*series.fields.front());
  for (size_t i = 0; i < series.examples.size(); ++i)
    equilibria = equilibria &&
                 guessed_motion(sight, series.starts[i], series.examples[i]).in_equilibrium.size();
  out.ways.resize(equilibria ? 2 : 1);
  for (size_t i = 0; i < series.fields.size(); ++i) {
    const int start = series.starts[i];
    out.scaled.push_back(moved_by_forces(sight.example(series.examples[i])) &&
                         (start < 0 || moved_by_forces(sight.example(start))));
    for (ComparedPlaces& way : out.ways) way.emplace_back();
    const VectorXd& seen = series.fields[i]->value;
    for (const GuessedMotion& beside :
         field_beside(sight, *series.fields[i], series.examples, series.starts)) {
      out.ways[0].back().push_back(field_sums(seen, beside.first_order));
      if (equilibria) out.ways[1].back().push_back(field_sums(seen, beside.in_equilibrium));
    }
  }
  return out;
}

/// Fields as photos: each stands in an example, and may show the motion of another.
void ask_for_exchanged_fields(Sight& sight, bool strains, Warnings& warnings) {
  const std::string what = strains ? "strain" : "motion";
  for (const FieldSeries& series : series_of_fields(sight, strains)) {
    if (series.fields.size() < 2) continue;
    for (const Exchange& one : exchanges({compared_fields(sight, series)}, sight.options())) {
      std::string which;
      for (size_t i = 0; i < one.places.size(); ++i) {
        const auto here = static_cast<size_t>(one.places[i]);
        const auto fits = static_cast<size_t>(one.fits[i]);
        which += fmt::format("{}{} shows the {} of example `{}`", i == 0 ? "" : ", and ",
                             series.fields[here]->field->told, what,
                             sight.example(series.examples[fits]).name);
        sight.doubt_load(series.examples[here]);
      }
      warnings.say(series.fields[static_cast<size_t>(one.places.front())]->place,
                   fmt::format("{}: of the squares of their {}s {:.0f} % are not as the first "
                               "guess expects them, and {:.2g} % once they are exchanged",
                               which, what, 100.0 * one.told, 100.0 * one.exchanged),
                   "the fields of these examples stand in one another's places");
    }
  }
}

}  // namespace

void ask_exchanges(Sight& sight, Warnings& warnings) {
  for (const auto& [camera, series] : series_by_camera(sight)) {
    Expectations expected(sight, series);
    for (const Exchange& one : exchanges(compared(sight, expected, series), sight.options()))
      if (moves(one, series, sight.options())) say_exchange(sight, one, series, warnings);
    ask_of_single_photos(sight, expected, series, warnings);
  }
  if (!sight.coarse()) return;
  for (const bool strains : {false, true}) ask_for_exchanged_fields(sight, strains, warnings);
}

}  // namespace hookeye::inspection
