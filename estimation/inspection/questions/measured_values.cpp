// Have measured forces, moments, travels and places the sign that the loads give them, and are
// they those of their own example?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "estimation/evaluation/sensor.h"
#include "estimation/inspection/exchanges.h"
#include "estimation/inspection/load_case.h"
#include "estimation/inspection/question.h"
#include "estimation/inspection/si.h"
#include "estimation/model/session_sensors.h"
#include "meshing/extent.h"

namespace hookeye::inspection {

namespace {

/// One measurement of a load case, less that at rest where there is one.
struct Reading {
  int example = 0;
  const MeasuredSpec* measured = nullptr;
  VectorXd value, first_order, in_equilibrium;
  bool less_shared = false;  ///< what all readings have, as a weight or a zero, is taken off
};
using Readings = std::vector<Reading>;

/// The same sensor in several examples.
std::tuple<int, std::string, std::vector<double>> sensor_of(const MeasuredSpec& measured) {
  std::vector<double> where(measured.point.begin(), measured.point.end());
  where.insert(where.end(), measured.direction.begin(), measured.direction.end());
  return {static_cast<int>(measured.kind), measured.region, where};
}

/// What the coarse model's sensor shows with its nodes at `q` under the reactions `R`.
VectorXd sensed(const CoarseModel& coarse, int e, const MeasuredSpec& measured, const VectorXd& q,
                const VectorXd& R) {
  Equilibrium state;
  state.q = q, state.R = R;
  return predicted(measured, {coarse.scene(), coarse.model(), e, state, Eigen::MatrixXd(), nullptr})
      .value;
}

/// Nothing is said of a case without an equilibrium, or of one that another question doubts.
bool can_be_read(Sight& sight, int e) {
  const FirstGuess& guess = *sight.guess(e);
  return guess.reaction.size() > 0 && guess.q.size() > 0 && !moved_by_unknown(sight.example(e)) &&
         !sight.load_doubted(e);
}

Reading read(Sight& sight, int e, const MeasuredSpec& measured) {
  const CoarseModel& coarse = *sight.coarse();
  const FirstGuess& guess = *sight.guess(e);
  const VectorXd X = coarse.scene().body->mesh.X.reshaped();
  const VectorXd rest = sensed(coarse, e, measured, X, VectorXd::Zero(X.size()));
  return {e,
          &measured,
          measured.value - rest,
          sensed(coarse, e, measured, X + guess.u, guess.reaction) - rest,
          sensed(coarse, e, measured, guess.q, guess.R) - rest,
          false};
}

/// Where an angle is counted from is told by the value alone then.
bool is_past_half_a_turn(const MeasuredSpec& measured) {
  return measured.kind == MeasuredSpec::Kind::rotation_of && std::abs(measured.value[0]) >= 180.0;
}

/// Readings of one sensor; those at rest are taken off the others.
std::vector<Readings> all_series(Sight& sight) {
  std::map<std::tuple<int, std::string, std::vector<double>>, Readings> by_sensor;
  for (size_t i = 0; i < sight.scene().capture.examples.size(); ++i) {
    const int e = static_cast<int>(i);
    if (!can_be_read(sight, e)) continue;
    for (const MeasuredSpec& measured : sight.example(e).measured)
      if (!measured.field && is_on_body(measured) && !is_past_half_a_turn(measured))
        by_sensor[sensor_of(measured)].push_back(read(sight, e, measured));
  }
  std::vector<Readings> out;
  for (auto& [sensor, series] : by_sensor) {
    const auto rest = std::find_if(series.begin(), series.end(), [&](const Reading& one) {
      return is_rest(sight.example(one.example));
    });
    if (rest != series.end()) {
      const Reading off = *rest;
      series.erase(rest);
      for (Reading& one : series) {
        one.value -= off.value;
        one.first_order -= off.first_order, one.in_equilibrium -= off.in_equilibrium;
        one.less_shared = true;
      }
    } else if (!is_reaction(*series.front().measured)) {
      continue;  // a weight that the capture leaves out may have moved it
    }
    out.push_back(std::move(series));
  }
  return out;
}

double cosine(const VectorXd& a, const VectorXd& b) {
  const double size = a.norm() * b.norm();
  return size > 0.0 ? a.dot(b) / size : 0.0;
}

/// The least force or moment that a weight, which the capture leaves out, cannot be: of the body's
/// told density, else of the heaviest soft body. Where what readings share is off, there is left
/// what a weight changes as the body deforms.
double beyond_weight(const Sight& sight, const Reading& one) {
  const MeasuredSpec& measured = *one.measured;
  const Capture& capture = sight.scene().capture;
  const bool weighs = capture.gravity && capture.body.density > 0.0;
  if (!is_reaction(measured) || weighs) return 0.0;
  const TetMesh& mesh = sight.scene().body->mesh;
  const double metre = capture.units.metre();
  const double kg = sight.options().heaviest_soft * quality(mesh).volume / (metre * metre * metre);
  const double own = capture.body.density * quality(mesh).volume * 9.81 * metre;
  const double weight = own > 0.0 ? own : 9.81 * kg / newtons(capture.units);
  const double share = one.less_shared ? sight.options().weight_moved : 1.0;
  return share *
         (measured.kind == MeasuredSpec::Kind::moment_on ? weight * extent(mesh.X) : weight);
}

/// Far enough from nothing, and expected alike to first order and in equilibrium: what second order
/// alone gives, as a twist's axial force, has no sure sign here.
bool sure(const Sight& sight, const Reading& one) {
  const InspectionOptions& options = sight.options();
  const double expected = one.in_equilibrium.norm();
  if (!(expected > 0.0) || cosine(one.first_order, one.in_equilibrium) < options.sure_cosine)
    return false;
  const double times = one.value.norm() / expected;
  return std::abs(std::log(times)) <= std::log(options.most_times_by_force) &&
         one.measured->whitened(one.value).norm() >= options.sure_sigmas &&
         one.value.norm() > beyond_weight(sight, one);
}

std::string told(const VectorXd& value) {
  std::string out;
  for (const double one : value) out += fmt::format("{}{:.3g}", out.empty() ? "" : ", ", one);
  return value.size() == 1 ? out : "(" + out + ")";
}

std::string sensor_in_words(const Sight& sight, const MeasuredSpec& measured) {
  const MeasuredKind& kind = kind_of(measured);
  return measured.region.empty() ? fmt::format("`{}` of {} {}", kind.name, told(measured.point),
                                               sight.scene().capture.units.length)
                                 : fmt::format("`{}: {}`", kind.name, measured.region);
}

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

/// Told values that stand in one another's places; the readings that are left.
Readings ask_for_exchanges(Sight& sight, const Readings& series, Warnings& warnings) {
  ComparedWays compared;
  compared.ways.resize(2);
  for (const Reading& one : series) {
    // Of a prescribed motion the force is known but for the stiffness, of a force the motion.
    compared.scaled.push_back(is_reaction(*one.measured) !=
                              moved_by_forces(sight.example(one.example)));
    for (ComparedPlaces& way : compared.ways) way.emplace_back();
    for (const Reading& other : series) {
      compared.ways[0].back().push_back(sums_of(one.value, other.first_order));
      compared.ways[1].back().push_back(sums_of(one.value, other.in_equilibrium));
    }
  }
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

}  // namespace

void ask_measured_values(Sight& sight, Warnings& warnings) {
  if (!sight.coarse()) return;
  for (const Readings& series : all_series(sight)) {
    ask_for_their_sizes(sight, series, warnings);
    ask_for_their_signs(sight, ask_for_exchanges(sight, series, warnings), warnings);
  }
}

}  // namespace hookeye::inspection
