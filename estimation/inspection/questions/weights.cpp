// Are density and gravity told in the capture's units?
#include <fmt/format.h>

#include <cmath>

#include "estimation/inspection/question.h"
#include "estimation/inspection/si.h"

namespace hookeye::inspection {

void ask_weights(Sight& sight, Warnings& warnings) {
  const Capture& capture = sight.scene().capture;
  const InspectionOptions& options = sight.options();
  const Units& units = capture.units;
  // [force s^2/length^4] in one kg/m^3
  const double si = 1.0 / (newtons(units) * std::pow(units.metre(), 4));
  if (capture.body.density > 0.0) {
    const double kg = capture.body.density / si;
    if (kg < options.least_density || kg > options.most_density)
      warnings.say(
          warnings.place({"body", "density"}),
          fmt::format("a density of {:.4g} is {:.3g} kg/m^3 in these units", capture.body.density,
                      kg),
          fmt::format("with {} and {}, water has {:.3g}", units.length, units.force, 1000.0 * si));
  }
  if (!capture.gravity) return;
  const double metres = capture.gravity->norm() / units.metre();
  if (metres > 0.0 && (metres < options.least_gravity || metres > options.most_gravity))
    warnings.say(
        warnings.place({"model", "gravity"}),
        fmt::format("a gravity of {:.4g} {} is {:.3g} m/s^2", capture.gravity->norm(),
                    units.acceleration(), metres),
        fmt::format("on earth it is {:.4g} {}", 9.81 * units.metre(), units.acceleration()));
}

}  // namespace hookeye::inspection
