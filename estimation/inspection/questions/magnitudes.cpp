// Do forces and moduli go together: does the body move as far as the first guess says, to an order
// of magnitude; and do prescribed motions?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimation/inspection/field_motion.h"
#include "estimation/inspection/load_case.h"
#include "estimation/inspection/question.h"

namespace hookeye::inspection {

namespace {

/// How many times the first guess is seen; 0: cannot be told.
struct Times {
  int example;
  double times;
  double seen_px, expected_px;
};

Times times_of(Sight& sight, int e) {
  const InspectionOptions& options = sight.options();
  const MotionSums& sums = sight.load_case(e).first_order;
  Times out{e, 0.0, sums.seen_px(), sums.expected_px()};
  if (sight.load_doubted(e) || sums.count == 0.0 || out.expected_px == 0.0) return out;
  if (out.seen_px >= options.least_motion_px && sums.cosine() >= options.astray_cosine)
    out.times = out.seen_px / out.expected_px;
  // What does not move has no direction, but is told where much was expected.
  if (out.seen_px < options.least_motion_px && out.expected_px > options.sure_motion_px)
    out.times = std::max(out.seen_px, 0.1) / out.expected_px;
  return out;
}

/// A unit that is this many times another, "" where none is near.
std::string unit_slip(double times) {
  const std::pair<double, const char*> slips[] = {{1000.0, "kN for N"},
                                                  {0.001, "mN for N"},
                                                  {9.81, "kilograms for N"},
                                                  {0.0102, "grams for N"}};
  for (const auto& [of, name] : slips)
    if (std::abs(std::log(times / of)) < std::log(3.2)) return fmt::format(" ({}?)", name);
  return {};
}

/// Where a support turns the body by 57 times what it should, or by a 57th.
std::string radians_slip(const ExampleSpec& example, double times,
                         const InspectionOptions& options) {
  const bool turns =
      std::any_of(example.supports.begin(), example.supports.end(), [](const SupportSpec& support) {
        return support.kind == SupportSpec::Kind::rigid && support.rigid.degrees != 0.0;
      });
  constexpr double kDegrees = 57.29578;
  return turns && std::abs(std::log(times / kDegrees)) < std::log(options.close_turn)
             ? " (radians for degrees?)"
             : "";
}

std::string more_or_less(double times) {
  return times > 1.0 ? fmt::format("{:.3g} times as far as", times)
                     : fmt::format("1/{:.3g} as far as", 1.0 / times);
}

/// Where the loads of an example are told.
Place loads_of(const Sight& sight, int e) {
  const ExampleSpec& example = sight.example(e);
  if (!example.loads.empty()) return example.loads.front().place;
  for (const SupportSpec& support : example.supports)
    if (support.kind == SupportSpec::Kind::rigid) return support.place;
  return example.place;
}

void say_of_forces(const Sight& sight, const std::vector<Times>& off, size_t asked,
                   Warnings& warnings) {
  double low = 1e300, high = 0.0;
  for (const Times& one : off) low = std::min(low, one.times), high = std::max(high, one.times);
  const bool alike = off.size() == asked && high < 10.0 * low && off.size() > 1;
  for (const Times& one : off) {
    const std::string seen = fmt::format(
        "the photos of example `{}` show the body move by {:.3g} px, {} the first guess ({:.2g} "
        "px)",
        sight.example(one.example).name, one.seen_px, more_or_less(one.times), one.expected_px);
    if (alike) {
      warnings.say(sight.scene().capture.materials.front().place,
                   fmt::format("{}, and it is much the same with all forces", seen),
                   fmt::format("moduli {} by about that factor, or all forces in another unit{}: "
                               "stresses are in {}",
                               one.times > 1.0 ? "lower" : "higher", unit_slip(one.times),
                               sight.scene().capture.units.stress()));
      return;
    }
    warnings.say(loads_of(sight, one.example), seen,
                 fmt::format("another unit of the force{}; forces are in {}", unit_slip(one.times),
                             sight.scene().capture.units.force));
  }
}

void say_of_strains(const Sight& sight, const FieldMotion& field, Warnings& warnings) {
  const InspectionOptions& options = sight.options();
  const double times = field.seen / field.expected;
  const double most = moved_by_forces(sight.example(field.example)) ? options.most_times_by_force
                                                                    : options.most_times_moved;
  if (std::abs(std::log(times)) <= std::log(most)) return;
  warnings.say(field.place,
               fmt::format("the strains of {} are {:.3g} millistrain (rms), {} the first guess "
                           "({:.2g})",
                           field.file, 1e3 * field.seen, more_or_less(times), 1e3 * field.expected),
               fmt::format("the field's `strain_unit` (percent, millistrain, microstrain; without "
                           "it, fractions), or loads and moduli in another unit: forces in {}, "
                           "stresses in {}, motions in {}",
                           sight.scene().capture.units.force, sight.scene().capture.units.stress(),
                           sight.scene().capture.units.length));
}

/// Fields of displacements against the first guess: their size, and whether it is the whole body
/// that moves otherwise.
void ask_of_fields(Sight& sight, Warnings& warnings) {
  const InspectionOptions& options = sight.options();
  const std::string& length = sight.scene().capture.units.length;
  const auto off = [](double times, double most) {
    return times > 0.0 && std::abs(std::log(times)) > std::log(most);
  };
  for (size_t i = 0; i < sight.scene().capture.examples.size(); ++i) {
    const int e = static_cast<int>(i);
    if (sight.load_doubted(e) || sight.guess(e)->turned) continue;
    for (const FieldMotion& field : field_motions(sight, e)) {
      if (field.expected == 0.0 || field.seen == 0.0) continue;
      const double times = field.seen / field.expected;
      const double bent = field.expected_bent > 0.0 ? field.seen_bent / field.expected_bent : 0.0;
      if (field.strain) {
        say_of_strains(sight, field, warnings);
        continue;
      }
      if (field.cosine <= -options.sure_cosine) {
        warnings.say(
            field.place,
            fmt::format("the points of {} move the other way than the first guess (cosine {:.2f})",
                        field.file, field.cosine),
            "displacements from the reference to the loaded body, in the field's `frame`; else the "
            "sign of the load, or a weight that the capture leaves out");
        sight.doubt_load(e);
        continue;
      }
      const std::string seen =
          fmt::format("the points of {} move by {:.3g} {}, {} the first guess ({:.2g} {})",
                      field.file, field.seen, length, more_or_less(times), field.expected, length);
      if (off(times, options.usual_times) && bent > 0.0 && !off(bent, options.usual_times) &&
          field.cosine_bent >= options.astray_cosine)
        warnings.say(field.place,
                     fmt::format("{}, but by {:.2g} and {:.2g} {} once a rigid motion is out of "
                                 "both",
                                 seen, field.seen_bent, field.expected_bent, length),
                     "a motion of the whole body that no support specifies: a grip or a machine "
                     "that gives way (`rigid: fit` on the support), or a field in a frame that "
                     "moves");
      else if (off(times, moved_by_forces(sight.example(e)) ? options.most_times_by_force
                                                            : options.most_times_moved))
        warnings.say(
            field.place, seen,
            fmt::format("the field's `unit` or `scale`, or loads and moduli in another "
                        "unit: forces in {}, stresses in {}, motions in {}, rotations in "
                        "degrees{}",
                        sight.scene().capture.units.force, sight.scene().capture.units.stress(),
                        length, radians_slip(sight.example(e), times, options)));
    }
  }
}

/// Where no photo tells, the strain to first order does.
void ask_of_strains(Sight& sight, Warnings& warnings) {
  const InspectionOptions& options = sight.options();
  for (size_t i = 0; i < sight.scene().capture.examples.size(); ++i) {
    const int e = static_cast<int>(i);
    const FirstGuess& guess = *sight.guess(e);
    if (sight.load_case(e).first_order.count > 0.0 || guess.strain <= options.most_strain ||
        guess.turned)
      continue;
    warnings.say(
        loads_of(sight, e),
        fmt::format("example `{}` would strain the body by {:.3g} to first order",
                    sight.example(e).name, guess.strain),
        fmt::format("loads, moduli and weight in one system of units: forces in {}, stresses "
                    "in {}",
                    sight.scene().capture.units.force, sight.scene().capture.units.stress()));
  }
}

}  // namespace

void ask_magnitudes(Sight& sight, Warnings& warnings) {
  if (!sight.coarse()) return;
  const InspectionOptions& options = sight.options();
  std::vector<Times> off;
  size_t asked = 0;
  for (size_t i = 0; i < sight.scene().capture.examples.size(); ++i) {
    const Times one = times_of(sight, static_cast<int>(i));
    if (one.times == 0.0) continue;
    const bool forces = moved_by_forces(sight.example(one.example));
    const double most = forces ? options.most_times_by_force : options.most_times_moved;
    asked += forces;
    if (std::abs(std::log(one.times)) <= std::log(most)) continue;
    sight.doubt_load(one.example);
    if (forces)
      off.push_back(one);
    else
      warnings.say(
          loads_of(sight, one.example),
          fmt::format("the photos of example `{}` show the body move by {:.3g} px, {} the told "
                      "motion would ({:.3g} px)",
                      sight.example(one.example).name, one.seen_px, more_or_less(one.times),
                      one.expected_px),
          fmt::format("motions are in {}, rotations in degrees{}",
                      sight.scene().capture.units.length,
                      radians_slip(sight.example(one.example), one.times, options)));
  }
  say_of_forces(sight, off, asked, warnings);
  ask_of_fields(sight, warnings);
  ask_of_strains(sight, warnings);
}

}  // namespace hookeye::inspection
