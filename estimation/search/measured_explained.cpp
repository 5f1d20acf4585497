#include "estimation/search/measured_explained.h"

#include <fmt/format.h>

#include "core/distributions.h"
#include "estimation/fit/at_floor.h"

namespace hookeye {

namespace {

/// "the force measured on 'grip'", of the words "force on".
std::string measured_in_words(const MeasuredSpec& told) {
  if (told.kind == MeasuredSpec::Kind::calibration)
    return "what the calibration has of the cameras";
  if (told.kind == MeasuredSpec::Kind::strain_of) return "a measured strain";
  if (told.region.empty()) return "a measured position";
  const std::string words = kind_of(told).words;
  const size_t at = words.rfind(' ');
  return fmt::format("the {} measured {} '{}'", words.substr(0, at), words.substr(at + 1),
                     told.region);
}

/// Of forces, positions and the like, or of the cameras' calibration.
struct Told {
  double r2 = 0.0, count = 0.0;
  double worst = 0.0;  ///< of one sensor
  std::string what;    ///< that one
};

Told told_of(const Fitted& fitted, bool held_out, bool on_body) {
  Told out;
  for (const auto& example : fitted.evaluation.examples)
    for (const auto& measured : example.measured) {
      const auto& spec = fitted.form.scene->capture.examples[example.example];
      const MeasuredSpec& told = spec.measured[measured.index];
      if (example.held_out != held_out || measured.is_field() || is_on_body(told) != on_body)
        continue;
      out.r2 += measured.r.squaredNorm(), out.count += measured.size();
      if (measured.r.norm() <= out.worst) continue;
      out.worst = measured.r.norm();
      out.what = measured_in_words(told) + (on_body ? fmt::format(" in '{}'", spec.name) : "");
    }
  return out;
}

}  // namespace

bool measured_explained(const Fitted& fitted, const Diagnosis& diagnosis, std::string* why) {
  bool fine = true;
  double worst = 0.0;
  // Seven numbers a camera, none of which is off, would hide a force that is.
  for (const bool on_body : {true, false})
    for (const bool held_out : {false, true}) {
      const double noise2 = on_body ? 1.0 + diagnosis.mesh_in_measured : 1.0;
      const Told told = told_of(fitted, held_out, on_body);
      if (told.count == 0.0 ||
          told.r2 / noise2 <= chi2_quantile(1.0 - diagnosis.floor.limits->floor.chance, told.count))
        continue;
      fine = false;
      if (told.worst <= worst) continue;
      worst = told.worst;
      if (why) *why = fmt::format("{} is {:.3g} times its told noise off", told.what, worst);
    }
  if (fine && why) why->clear();
  return fine;
}

bool photos_explained(const Fitted& fitted, const Diagnosis& diagnosis) {
  const Floor& floor = diagnosis.floor;
  // Beside photos, whose floor is another, fields answer for themselves.
  const double most = floor.limits->floor.at *
                      (fitted.evaluation.seen() == Evaluation::Seen::photos ? 1.0 : floor.chi);
  return explains_photos(fitted, floor) && !most_moved(diagnosis.motions) &&
         fitted.evaluation.field_chi(false) <= most && fitted.evaluation.field_chi(true) <= most;
}

bool explained(const Fitted& fitted, const Diagnosis& diagnosis) {
  return photos_explained(fitted, diagnosis) && measured_explained(fitted, diagnosis);
}

}  // namespace hookeye
