// Are angles in degrees? Radians are told by their digits: 0.5236 is pi/6, and by a support that
// turns its region by another angle than a sensor tells of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "estimation/inspection/question.h"

namespace hookeye::inspection {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

/// A told angle.
struct Angle {
  double value;
  Place place;
  std::string of;  ///< "the rotation of `grip` of example `twist`"
};

/// Read as radians it is a multiple of 5 degrees, as near as its digits tell, and by no chance:
/// these leave less than one number in 200.
bool has_digits_of_radians(double value, const InspectionOptions& options) {
  constexpr double kStep = 5.0;
  const std::string text = fmt::format("{}", std::abs(value));
  const size_t point = text.find('.');
  if (point == std::string::npos || text.find('e') != std::string::npos) return false;
  const double half = 0.5 * std::pow(10.0, -static_cast<double>(text.size() - point - 1));
  if (std::abs(value) > 2.0 * std::numbers::pi) return false;
  const double degrees = kDegrees * std::abs(value);
  const double nearest = kStep * std::round(degrees / kStep);
  return nearest > 0.0 && 2.0 * kDegrees * half < options.digits_by_chance * kStep &&
         std::abs(degrees - nearest) <= 1.01 * kDegrees * half + 1e-12 * degrees;
}

std::vector<Angle> told_angles(const Sight& sight) {
  std::vector<Angle> out;
  for (const ExampleSpec& example : sight.scene().capture.examples) {
    for (const SupportSpec& support : example.supports)
      if (support.kind == SupportSpec::Kind::rigid && support.rigid.degrees != 0.0)
        out.push_back(
            {support.rigid.degrees, support.place,
             fmt::format("the rotation of `{}` of example `{}`", support.region, example.name)});
    for (const MeasuredSpec& measured : example.measured)
      if (measured.kind == MeasuredSpec::Kind::rotation_of && measured.value[0] != 0.0)
        out.push_back(
            {measured.value[0], measured.place,
             fmt::format("`rotation_of: {}` of example `{}`", measured.region, example.name)});
  }
  return out;
}

/// All of them, as one lucky number among many is none.
void ask_of_digits(const Sight& sight, Warnings& warnings) {
  const std::vector<Angle> all = told_angles(sight);
  if (all.empty() || !std::all_of(all.begin(), all.end(), [&](const Angle& one) {
        return has_digits_of_radians(one.value, sight.options());
      }))
    return;
  const Angle& first = all.front();
  warnings.say(
      first.place,
      fmt::format(
          "{} is {} degrees{}: as radians it would be {:.4g} degrees", first.of, first.value,
          all.size() > 1 ? fmt::format(", and the other {} look alike", all.size() - 1) : "",
          kDegrees * first.value),
      "angles are in degrees: multiply radians by 180/pi");
}

/// A sensor of a region that a support turns about the same axis.
void ask_of_sensors(const Sight& sight, Warnings& warnings) {
  for (const ExampleSpec& example : sight.scene().capture.examples)
    for (const MeasuredSpec& measured : example.measured) {
      if (measured.kind != MeasuredSpec::Kind::rotation_of) continue;
      for (const SupportSpec& support : example.supports) {
        if (support.kind != SupportSpec::Kind::rigid || support.region != measured.region) continue;
        const double about = support.rigid.axis.normalized().dot(measured.direction);
        const double told = about * support.rigid.degrees, seen = measured.value[0];
        if (std::abs(about) < 0.99 || !(told * seen > 0.0)) continue;
        const double times = told / seen;
        const auto near = [&](double of) {
          return std::abs(std::log(times / of)) < std::log(sight.options().close_unit);
        };
        if (!near(kDegrees) && !near(1.0 / kDegrees)) continue;
        const bool sensor = near(kDegrees);
        warnings.say(
            sensor ? measured.place : support.place,
            fmt::format("the support turns `{}` of example `{}` by {:.4g} degrees, and its "
                        "`rotation_of` is {:.4g}",
                        support.region, example.name, told, seen),
            fmt::format("both are in degrees: {} in radians?",
                        sensor ? "is the measured one" : "is the support's"));
        return;
      }
    }
}

}  // namespace

void ask_angles(Sight& sight, Warnings& warnings) {
  ask_of_digits(sight, warnings);
  ask_of_sensors(sight, warnings);
}

}  // namespace hookeye::inspection
