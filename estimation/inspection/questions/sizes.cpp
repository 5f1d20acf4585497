// Do the units go with the numbers? A change of units scales body, cameras, moduli and weights
// together, so that pictures and motions stay the same; only their sizes in SI tell.
#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "estimation/inspection/question.h"
#include "estimation/inspection/si.h"
#include "meshing/extent.h"

namespace hookeye::inspection {

namespace {

/// What a capture tells, in its own units.
struct Sizes {
  double body = 0.0;     ///< [length]
  double modulus = 0.0;  ///< shear at rest [stress]; 0: none
  double camera = 0.0;   ///< distance of the nearest one [length]; 0: none
  std::string camera_name;
  std::optional<double> density, gravity;  ///< [force s^2/length^4], [length/s^2]
};

/// The same in SI.
Sizes in_si(Sizes sizes, const Units& units) {
  const double length = 1.0 / units.metre(), force = newtons(units);
  sizes.body *= length, sizes.camera *= length;
  sizes.modulus *= force / (length * length);
  if (sizes.density) *sizes.density *= force / std::pow(length, 4);
  if (sizes.gravity) *sizes.gravity *= length;
  return sizes;
}

Sizes sizes_of(const Sight& sight) {
  const Scene& scene = sight.scene();
  Sizes out;
  const Matrix3Xd& X = scene.body->surface.mesh.X;
  out.body = extent(X);
  for (const auto& part : sight.model().energy.parts) {
    const double mu = part.term->dP_dF(Eigen::Matrix3d::Identity())(3, 3);
    if (out.modulus == 0.0 && mu > 0.0) out.modulus = mu;
  }
  for (const Camera& camera : scene.capture.cameras) {
    if (!camera.model->central()) continue;
    const double distance = (camera.centre() - X.rowwise().mean()).norm();
    if (out.camera == 0.0 || distance < out.camera)
      out.camera = distance, out.camera_name = camera.name;
  }
  if (scene.capture.body.density > 0.0) out.density = scene.capture.body.density;
  if (scene.capture.gravity && scene.capture.gravity->norm() > 0.0)
    out.gravity = scene.capture.gravity->norm();
  return out;
}

/// Decades by which a number is out of its range.
double decades_out(double value, double least, double most) {
  return value < least ? std::log10(least / value) : std::max(std::log10(value / most), 0.0);
}

double body_out(const Sizes& si, const InspectionOptions& options) {
  return decades_out(si.body, options.smallest_body, options.largest_body);
}

double modulus_out(const Sizes& si, const InspectionOptions& options) {
  return si.modulus > 0.0 ? decades_out(si.modulus, options.softest_guess, options.stiffest_guess)
                          : 0.0;
}

double all_out(const Sizes& si, const InspectionOptions& options) {
  double out = body_out(si, options) + modulus_out(si, options);
  if (si.density) out += decades_out(*si.density, options.least_density, options.most_density);
  if (si.gravity) out += decades_out(*si.gravity, options.least_gravity, options.most_gravity);
  return out;
}

/// Units in which all numbers are usual: with the same force if there are such.
std::optional<Units> better_units(const Sizes& told, Units units,
                                  const InspectionOptions& options) {
  const std::string told_force = units.force;
  for (const std::string& force : {told_force, std::string("N"), std::string("mN")})
    for (const char* length : {"mm", "cm", "m", "um"}) {
      units.length = length, units.force = force;
      if (all_out(in_si(told, units), options) == 0.0) return units;
    }
  return std::nullopt;
}

/// The first usual unit of length in which the body is usual, whatever the other numbers are.
std::optional<Units> units_of_body(const Sizes& told, Units units,
                                   const InspectionOptions& options) {
  for (const char* length : {"mm", "cm", "m", "um"}) {
    units.length = length;
    if (body_out(in_si(told, units), options) == 0.0) return units;
  }
  return std::nullopt;
}

std::string in_words(const Sizes& si) {
  std::string out = fmt::format("the body is {} long", length_in_words(si.body));
  if (si.modulus > 0.0) out += fmt::format(", its shear modulus {}", stress_in_words(si.modulus));
  if (si.camera > 0.0)
    out += fmt::format(", camera `{}` {} away", si.camera_name, length_in_words(si.camera));
  return out;
}

/// Why a size is beyond what is photographed: where the limits of options.h are from.
std::string why_out(const Sizes& si, const InspectionOptions& options) {
  const std::string smallest = length_in_words(options.smallest_body),
                    largest = length_in_words(options.largest_body),
                    softest = stress_in_words(options.softest_guess),
                    stiffest = stress_in_words(options.stiffest_guess);
  std::string out;
  if (si.body < options.smallest_body)
    out += fmt::format("; a light microscope shows no body below {}", smallest);
  if (si.body > options.largest_body)
    out += fmt::format("; beyond {} there are not even balloons or airbags", largest);
  if (modulus_out(si, options) > 0.0)
    out += si.modulus < options.softest_guess
               ? fmt::format("; the softest gels have ten times {}", softest)
               : fmt::format("; hard plastics have a tenth of {}", stiffest);
  return out;
}

/// Lengths alone are in another unit, as where moduli were converted: how they are told there.
std::string with_moduli(const Sizes& si, const Sizes& told, const Units& units) {
  const double pascals = newtons(units) * std::pow(units.metre(), 2);
  return fmt::format(
      "`units: {{length: {}, force: {}}}`, in which the body is {} long, and moduli in {}: {} is "
      "{:.3g} there",
      units.length, units.force, length_in_words(in_si(told, units).body), units.stress(),
      stress_in_words(si.modulus), si.modulus / pascals);
}

}  // namespace

void ask_sizes(Sight& sight, Warnings& warnings) {
  const InspectionOptions& options = sight.options();
  const Units& units = sight.scene().capture.units;
  const Sizes told = sizes_of(sight);
  const Sizes si = in_si(told, units);
  const double body = body_out(si, options), modulus = modulus_out(si, options);
  if (body == 0.0 && modulus == 0.0) return;
  const std::string seen = fmt::format("in {} and {} {}{}", units.length, units.force, in_words(si),
                                       why_out(si, options));
  const auto of_body = units_of_body(told, units, options);
  if (body > 0.0 && modulus == 0.0 && si.modulus > 0.0 && of_body &&
      modulus_out(in_si(told, *of_body), options) > 0.0) {
    warnings.say(warnings.place({"units"}), seen, with_moduli(si, told, *of_body));
    return;
  }
  if (const auto better = better_units(told, units, options)) {
    warnings.say(warnings.place({"units"}), seen,
                 fmt::format("`units: {{length: {}, force: {}}}`, in which {}", better->length,
                             better->force, in_words(in_si(told, *better))));
    return;
  }
  if (body > 0.0)
    warnings.say(warnings.place({"units"}), seen,
                 fmt::format("a body from {} to {} that one camera sees: lengths of body, cameras "
                             "and regions in {}",
                             length_in_words(options.smallest_body),
                             length_in_words(options.largest_body), units.length));
  else
    warnings.say(sight.scene().capture.materials.front().place, seen,
                 fmt::format("a shear modulus from {} to {}; stresses are in {}",
                             stress_in_words(options.softest_guess),
                             stress_in_words(options.stiffest_guess), units.stress()));
}

}  // namespace hookeye::inspection
