#include "estimation/search/measured_explained.h"

#include <fmt/format.h>

#include "core/distributions.h"
#include "estimation/fit/at_floor.h"

namespace hookeye {

namespace {

/// "the force measured on 'grip'", of the words "force on".
std::string measured_in_words(const MeasuredSpec& told) {
  const std::string words = kind_of(told).words;
  const size_t at = words.rfind(' ');
  return fmt::format("the {} measured {} '{}'", words.substr(0, at), words.substr(at + 1),
                     told.region);
}

}  // namespace

bool measured_explained(const Fitted& fitted, const Diagnosis& diagnosis, std::string* why) {
  const double noise2 = 1.0 + diagnosis.mesh_in_measured;
  bool fine = true;
  double worst = 0.0;
  for (const bool held_out : {false, true}) {
    double sum = 0.0, count = 0.0;
    for (const auto& example : fitted.evaluation.examples)
      for (const auto& measured : example.measured) {
        if (example.held_out != held_out || measured.is_field()) continue;
        sum += measured.r.squaredNorm(), count += measured.size();
        if (measured.r.norm() <= worst) continue;
        worst = measured.r.norm();
        const auto& spec = fitted.form.scene->capture.examples[example.example];
        const MeasuredSpec& told = spec.measured[measured.index];
        if (why)
          *why = fmt::format("{} in '{}' is {:.3g} times its told noise off",
                             told.region.empty() ? "a measured position" : measured_in_words(told),
                             spec.name, worst);
      }
    if (count > 0.0 &&
        sum / noise2 > chi2_quantile(1.0 - diagnosis.floor.limits->floor.chance, count))
      fine = false;
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
