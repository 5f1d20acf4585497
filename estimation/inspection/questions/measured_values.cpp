// Have measured forces, moments, travels and places the axes, the sign and the unit that the loads
// give them, and are they those of their own example?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "estimation/evaluation/sensor.h"
#include "estimation/inspection/axes_read.h"
#include "estimation/inspection/exchanges.h"
#include "estimation/inspection/load_case.h"
#include "estimation/inspection/question.h"
#include "estimation/inspection/readings.h"
#include "estimation/model/session_sensors.h"

namespace hookeye::inspection {

namespace {

MotionSums sums_of(const VectorXd& seen, const VectorXd& expected) {
  MotionSums sums;
  sums.seen2 = seen.squaredNorm(), sums.expected2 = expected.squaredNorm();
  sums.both = seen.dot(expected), sums.count = 1.0;
  return sums;
}

/// What is left of the squares of an exchange's values if they have the other sign instead: of a
/// push and a pull either would do, but for their sizes.
double reversed_left(ComparedWays compared, const Exchange& one) {
  for (ComparedPlaces& way : compared.ways)
    for (auto& row : way)
      for (MotionSums& sums : row) sums.both = -sums.both;
  return share_left(compared, one.places, one.places);
}

/// Of a prescribed motion the force is known but for the stiffness, of a force the motion.
bool scaled_by_stiffness(const Sight& sight, const Reading& one) {
  return is_reaction(*one.measured) != moved_by_forces(sight.example(one.example));
}

ComparedWays compared_readings(const Sight& sight, const Readings& series) {
  ComparedWays compared;
  compared.ways.resize(2);
  for (const Reading& one : series) {
    compared.scaled.push_back(scaled_by_stiffness(sight, one));
    for (ComparedPlaces& way : compared.ways) way.emplace_back();
    for (const Reading& other : series) {
      compared.ways[0].back().push_back(sums_of(one.value, other.first_order));
      compared.ways[1].back().push_back(sums_of(one.value, other.in_equilibrium));
    }
  }
  return compared;
}

/// Told values that stand in one another's places; the readings that are left.
Readings ask_for_exchanges(Sight& sight, const Readings& series, Warnings& warnings) {
  const ComparedWays compared = compared_readings(sight, series);
  std::vector<char> taken(series.size(), 0);
  for (const Exchange& one : exchanges({compared}, sight.options())) {
    std::string which;
    bool one_is_sure = false;  // the other may be a twist, whose force is next to nothing
    for (size_t i = 0; i < one.places.size(); ++i) {
      const Reading& here = series[static_cast<size_t>(one.places[i])];
      Reading fits = series[static_cast<size_t>(one.fits[i])];
      which += fmt::format("{}that of example `{}`, {}, fits example `{}`", i == 0 ? "" : ", and ",
                           sight.example(here.example).name, told(here.measured->value),
                           sight.example(fits.example).name);
      fits.value = here.value;
      one_is_sure = one_is_sure || (sure(sight, fits) && cosine(fits.value, fits.in_equilibrium) >=
                                                             sight.options().sure_cosine);
    }
    if (!one_is_sure || reversed_left(compared, one) <= one.exchanged) continue;
    for (const int place : one.places) taken[static_cast<size_t>(place)] = 1;
    const Reading& first = series[static_cast<size_t>(one.places.front())];
    warnings.say(first.measured->place,
                 fmt::format("of {} {}: {:.0f} % of their squares are not as the first guess "
                             "expects them, and {:.2g} % once they are exchanged",
                             sensor_in_words(sight, *first.measured), which, 100.0 * one.told,
                             100.0 * one.exchanged),
                 "the values of these examples stand in one another's places");
  }
  Readings rest;
  for (size_t i = 0; i < series.size(); ++i)
    if (!taken[i]) rest.push_back(series[i]);
  return rest;
}

std::string seen_in_photos(Sight& sight, int e) {
  const MotionSums& sums = sight.load_case(e).first_order;
  if (sums.seen_px() < sight.options().least_motion_px ||
      sums.cosine() < sight.options().sure_cosine)
    return {};
  return fmt::format("; its photos show the body move as the capture tells (cosine {:.2f})",
                     sums.cosine());
}

/// Readings of forces less the mean of all: a weight that the capture leaves out, and a zero that
/// drifted, are off then.
Readings less_their_mean(const Readings& series) {
  if (series.size() < 2 || series.front().less_shared || !is_reaction(*series.front().measured))
    return {};
  Reading mean = series.front();
  for (size_t i = 1; i < series.size(); ++i) {
    mean.value += series[i].value;
    mean.first_order += series[i].first_order, mean.in_equilibrium += series[i].in_equilibrium;
  }
  const double share = 1.0 / static_cast<double>(series.size());
  Readings out = series;
  for (Reading& one : out) {
    one.value -= share * mean.value;
    one.first_order -= share * mean.first_order;
    one.in_equilibrium -= share * mean.in_equilibrium;
    one.less_shared = true;
  }
  return out;
}

/// Which of the sure ones have the other sign.
struct SignsFound {
  std::vector<size_t> against;
  size_t asked = 0;
  bool all() const { return asked > 1 && against.size() == asked; }
};

SignsFound signs_of(const Sight& sight, const Readings& series) {
  SignsFound out;
  for (size_t i = 0; i < series.size(); ++i) {
    if (!sure(sight, series[i])) continue;
    ++out.asked;
    if (cosine(series[i].value, series[i].in_equilibrium) <= -sight.options().sure_cosine)
      out.against.push_back(i);
  }
  return out;
}

void ask_for_their_signs(Sight& sight, const Readings& series, Warnings& warnings) {
  SignsFound signs = signs_of(sight, series);
  const Readings centred = signs.asked == 0 ? less_their_mean(series) : Readings{};
  if (!centred.empty()) {
    signs = signs_of(sight, centred);
    if (!signs.all()) return;  // of one alone the others may be what is wrong
  }
  for (const size_t i : signs.against) {
    const Reading& one = centred.empty() ? series[i] : centred[i];
    const MeasuredSpec& measured = *one.measured;
    const char* meaning = is_reaction(measured)
                              ? "`value` is what the support exerts on the body, not the body on it"
                              : "`value` is told in the world's axes";
    warnings.say(
        measured.place,
        fmt::format(
            "{} of example `{}` is {}{}, where its loads and supports give {} {} by the "
            "first guess: the other sign{}{}",
            sensor_in_words(sight, measured), sight.example(one.example).name,
            told(centred.empty() ? measured.value : one.value),
            centred.empty() ? "" : " less the mean of all", told(one.in_equilibrium),
            measured_unit(measured, sight.scene().capture.units),
            signs.all() ? fmt::format(", as in all {} examples where it is sure", signs.asked) : "",
            seen_in_photos(sight, one.example)),
        fmt::format("{}: change the sign{}", meaning, signs.all() ? " in all of them" : ""));
    if (signs.all()) return;
  }
}

/// How many times what the first guess gives is measured, where that has a direction; 0: it has
/// not.
double times_expected(const Reading& one, const InspectionOptions& options) {
  if (cosine(one.value, one.in_equilibrium) < options.sure_cosine) return 0.0;
  return one.value.dot(one.in_equilibrium) / one.in_equilibrium.squaredNorm();
}

/// Forces that a prescribed motion takes tell the modulus, or their unit is another one.
void ask_for_their_sizes(const Sight& sight, const Readings& series, Warnings& warnings) {
  const InspectionOptions& options = sight.options();
  const Reading* largest = nullptr;
  for (const Reading& one : series) {
    if (!is_reaction(*one.measured) || moved_by_forces(sight.example(one.example))) continue;
    if (!(one.in_equilibrium.squaredNorm() > 0.0)) continue;
    const double times = times_expected(one, options);
    if (times == 0.0 || std::abs(std::log(times)) <= std::log(options.most_times_by_force)) return;
    if (!largest || one.value.norm() > largest->value.norm()) largest = &one;
  }
  if (!largest) return;
  const double times = times_expected(*largest, options);
  const Units& units = sight.scene().capture.units;
  warnings.say(
      largest->measured->place,
      fmt::format("{} of example `{}` is {}, where the first guess gives {} {}, and it is much the "
                  "same with the others",
                  sensor_in_words(sight, *largest->measured), sight.example(largest->example).name,
                  told(largest->value), told(largest->in_equilibrium),
                  measured_unit(*largest->measured, units)),
      fmt::format("moduli of about {:.1g} times those told, or the values in another unit: forces "
                  "are in {}, stresses in {}",
                  times, units.force, units.stress()));
}

/// A reading's size over that which the first guess gives it; 0: it has no sure direction.
double times_either_way(const Reading& one, const InspectionOptions& options) {
  if (std::abs(cosine(one.value, one.in_equilibrium)) < options.sure_cosine ||
      cosine(one.first_order, one.in_equilibrium) < options.sure_cosine)
    return 0.0;
  return one.value.norm() / one.in_equilibrium.norm();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Single values in another unit than the others of their sensor; the readings that are left.
Readings ask_for_single_units(const Sight& sight, const Readings& series, Warnings& warnings) {
  const InspectionOptions& options = sight.options();
  std::vector<double> times, scaled;
  for (const Reading& one : series) {
    times.push_back(is_reaction(*one.measured) ? times_either_way(one, options) : 0.0);
    if (times.back() > 0.0 && scaled_by_stiffness(sight, one)) scaled.push_back(times.back());
  }
  // Of two neither is the one that is off: three have a majority.
  const double usual = scaled.size() > 2 ? median(scaled) : 0.0;
  Readings rest;
  for (size_t i = 0; i < series.size(); ++i) {
    const Reading& one = series[i];
    const double expected = scaled_by_stiffness(sight, one) ? usual : 1.0;
    const double off = times[i] > 0.0 && expected > 0.0 ? times[i] / expected : 1.0;
    // Beside next to nothing, as the axial force of a twist, a zero that drifted is many times it.
    const VectorXd due = expected * one.in_equilibrium;
    const bool is_due = one.measured->whitened(due).norm() >= options.sure_sigmas &&
                        due.norm() > beyond_weight(sight, one);
    if (!is_due || std::abs(std::log(off)) <= std::log(options.most_times_by_force)) {
      rest.push_back(one);
      continue;
    }
    const Units& units = sight.scene().capture.units;
    warnings.say(
        one.measured->place,
        fmt::format("{} of example `{}` is {}, {:.2g} times what the first guess gives it{}",
                    sensor_in_words(sight, *one.measured), sight.example(one.example).name,
                    told(one.measured->value), off,
                    scaled_by_stiffness(sight, one) ? " beside the other examples"
                                                    : ", where forces alone move the body"),
        fmt::format("this value in {}: it seems to be in another unit",
                    measured_unit(*one.measured, units)));
  }
  return rest;
}

/// Vectors of one sensor; none where it tells single numbers.
ToldVectors vectors_of(const Sight& sight, const Readings& series) {
  ToldVectors out;
  const auto n = static_cast<Eigen::Index>(series.size());
  out.told.resize(3, n), out.expected.assign(2, Matrix3Xd(3, n));
  Vector3d sigmas2 = Vector3d::Zero();
  for (Eigen::Index i = 0; i < n; ++i) {
    const Reading& one = series[static_cast<size_t>(i)];
    out.told.col(i) = one.value;
    out.expected[0].col(i) = one.first_order, out.expected[1].col(i) = one.in_equilibrium;
    out.scaled.push_back(scaled_by_stiffness(sight, one));
    out.sure.push_back(one.measured->whitened(one.value).norm() >= sight.options().sure_sigmas &&
                       one.value.norm() > beyond_weight(sight, one));
    for (int k = 0; k < 3; ++k) {
      const VectorXd along = one.value[k] * VectorXd::Unit(3, k);
      if (std::abs(one.value[k]) > beyond_weight(sight, one))
        sigmas2[k] += one.measured->whitened(along).squaredNorm();
    }
  }
  for (int k = 0; k < 3; ++k)
    out.sure_told[static_cast<size_t>(k)] =
        sigmas2[k] >= sight.options().sure_sigmas * sight.options().sure_sigmas;
  return out;
}

void say_axes(const Sight& sight, const Readings& series, const AxesRead& read,
              const std::string& whose, Warnings& warnings) {
  warnings.say(series.front().measured->place,
               fmt::format("{} of {} is not as loads and supports give it by the first guess: on "
                           "the axes in question {:.0f} % of the squares are left, and {:.2g} % if "
                           "{}",
                           sensor_in_words(sight, *series.front().measured), whose,
                           100.0 * read.told, 100.0 * read.read, read.in_words()),
               "`value` in the world's axes, as those of loads and supports");
}

/// What is left of all readings once those that stand in one another's places are exchanged.
double left_by_exchanges(const Sight& sight, const Readings& series) {
  const ComparedWays compared = compared_readings(sight, series);
  std::vector<int> places(series.size());
  std::iota(places.begin(), places.end(), 0);
  std::vector<int> fits = places;
  for (const Exchange& one : exchanges({compared}, sight.options()))
    for (size_t i = 0; i < one.places.size(); ++i)
      fits[static_cast<size_t>(one.places[i])] = one.fits[i];
  return share_left(compared, places, fits);
}

/// Vectors in other axes than told, all of them or single ones: what leaves less. The readings that
/// are left.
Readings ask_for_their_axes(const Sight& sight, const Readings& series, Warnings& warnings) {
  if (series.front().value.size() != 3) return series;
  const ToldVectors vectors = vectors_of(sight, series);
  ToldVectors by_singles = vectors, by_all = vectors;
  std::vector<std::optional<AxesRead>> singles;
  for (size_t i = 0; i < series.size(); ++i) {
    const auto column = static_cast<int>(i);
    singles.push_back(read_otherwise(vectors, {column}, sight.options()));
    if (singles.back() && singles.back()->whole) singles.back().reset();
    if (singles.back()) by_singles.told.col(column) = singles.back()->of(vectors.told.col(column));
  }
  const auto all = read_otherwise(vectors, {}, sight.options());
  if (all && !all->whole && series.size() > 1) {
    by_all.told = all->of(vectors.told);
    const double left = share_left(by_all);
    if (left < share_left(by_singles) && left < left_by_exchanges(sight, series)) {
      say_axes(sight, series, *all, fmt::format("all {} examples", series.size()), warnings);
      return {};
    }
  }
  if (left_by_exchanges(sight, series) < share_left(by_singles)) return series;
  Readings rest;
  for (size_t i = 0; i < series.size(); ++i) {
    if (singles[i])
      say_axes(sight, {series[i]}, *singles[i],
               fmt::format("example `{}`", sight.example(series[i].example).name), warnings);
    else
      rest.push_back(series[i]);
  }
  return rest;
}

}  // namespace

void ask_measured_values(Sight& sight, Warnings& warnings) {
  if (!sight.coarse()) return;
  for (const Readings& series : all_series(sight)) {
    ask_for_their_sizes(sight, series, warnings);
    Readings left = ask_for_single_units(sight, series, warnings);
    if (!left.empty()) left = ask_for_their_axes(sight, left, warnings);
    if (!left.empty())
      ask_for_their_signs(sight, ask_for_exchanges(sight, left, warnings), warnings);
  }
}

}  // namespace hookeye::inspection
