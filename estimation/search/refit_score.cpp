#include "estimation/search/refit_score.h"

#include <algorithm>
#include <cmath>

#include "estimation/diagnosis/diagnosis.h"
#include "estimation/diagnosis/diagnosis_sums.h"

namespace hookeye {

namespace {

struct EffectiveMisfit {
  double r2 = 0.0, count = 0.0;
  EffectiveMisfit operator+(const EffectiveMisfit& other) const {
    return {r2 + other.r2, count + other.count};
  }
  /// Variance, `least` at least.
  double noise(double least) const { return count > 0.0 ? std::max(least, r2 / count) : least; }
  double log_likelihood(double least) const {
    return -0.5 * count * std::log(noise(least)) - 0.5 * r2 / noise(least);
  }
};

/// |z|^2 of the photos of `fitted` with the weights that the correlation in `reference` gives; of
/// the fitted examples or of those held out.
EffectiveMisfit photo_misfit(const Fitted& fitted, const Fitted& reference, bool held_out) {
  EffectiveMisfit out;
  for (size_t e = 0; e < fitted.evaluation.examples.size(); ++e) {
    const auto& example = fitted.evaluation.examples[e];
    if (example.held_out != held_out) continue;
    const auto weights = photo_statistics(reference.evaluation.examples[e].photos);
    for (size_t k = 0; k < example.photos.size(); ++k) {
      const FlowStatistics own = flow_statistics(example.photos[k].flow);
      const FlowStatistics& weight = weights[k];
      if (own.count == 0.0 || weight.count == 0.0) continue;
      const double w = weight.effective / weight.count;
      out.r2 += w * own.variance * weight.count;
      out.count += w * weight.count;
    }
  }
  return out;
}

/// The same of fields, each number as a cell.
EffectiveMisfit field_misfit(const Fitted& fitted, const Fitted& reference, bool held_out) {
  EffectiveMisfit out;
  for (size_t e = 0; e < fitted.evaluation.examples.size(); ++e) {
    const auto& example = fitted.evaluation.examples[e];
    if (example.held_out != held_out) continue;
    for (size_t k = 0; k < example.measured.size(); ++k) {
      const MeasuredEvaluation& field = example.measured[k];
      if (!field.is_field()) continue;
      const double effective = reference.evaluation.examples[e].measured[k].effective;
      out.r2 += effective / field.size() * field.r.squaredNorm();
      out.count += effective;
    }
  }
  return out;
}

/// Of photos and fields together.
EffectiveMisfit seen_misfit(const Fitted& fitted, const Fitted& reference, bool held_out) {
  return photo_misfit(fitted, reference, held_out) + field_misfit(fitted, reference, held_out);
}

/// The same of forces, moments and positions.
EffectiveMisfit measured_misfit(const Fitted& fitted, bool held_out_alone) {
  EffectiveMisfit out;
  for (const auto& example : fitted.evaluation.examples)
    for (const auto& measured : example.measured)
      if ((!held_out_alone || example.held_out) && !measured.is_field())
        out = out + EffectiveMisfit{measured.r.squaredNorm(), measured.size()};
  return out;
}

/// |r|^2 of all pixels, or of all numbers of the fields where no photo is.
double seen_r2(const Fitted& fitted) {
  const bool photos = fitted.evaluation.seen() == Evaluation::Seen::photos;
  double out = 0.0;
  for (const auto& example : fitted.evaluation.examples) {
    for (const auto& photo : example.photos) out += photo.r2;
    for (const auto& measured : example.measured)
      if (!photos && measured.is_field()) out += measured.r.squaredNorm();
  }
  return out;
}

int parameters_of_sensors(const ModelForm& form) {
  int count = 0;
  for (const auto& ingredient : form.ingredients)
    if (sensors_alone(*ingredient)) count += static_cast<int>(ingredient->parameters().size());
  return count;
}

}  // namespace

double misfit(const Fitted& fitted) {
  return fitted.evaluation.chi(false) + fitted.evaluation.chi(true);
}

double measured_noise2(const Fitted& fitted) { return measured_misfit(fitted, false).noise(1.0); }

double refit_score(const Fitted& fitted, const Yardstick& yardstick) {
  const EffectiveMisfit photos = seen_misfit(fitted, *yardstick.reference, false),
                        held_out = seen_misfit(fitted, *yardstick.reference, true);
  const EffectiveMisfit measured = measured_misfit(fitted, false);
  const int of_sensors = parameters_of_sensors(fitted.form);
  const auto price = [](int parameters, double count) {
    return 0.5 * parameters * std::log(std::max(count, 2.0));
  };
  const double count = photos.count + held_out.count + measured.count;
  return photos.log_likelihood(yardstick.floor->cell_variance) +
         held_out.log_likelihood(yardstick.floor->cell_variance) -
         0.5 * measured.r2 / yardstick.measured_noise2 -
         price(fitted.form.size() - of_sensors, count) - price(of_sensors, measured.count);
}

bool held_out_allows(const Fitted& with, const Fitted& without, const Floor& floor, double least) {
  const auto r2 = [](const Fitted& fitted) { return std::pow(fitted.evaluation.chi(true), 2); };
  const EffectiveMisfit before = measured_misfit(without, true),
                        after = measured_misfit(with, true);
  double loss = 0.5 * (after.r2 - before.r2) / std::min(before.noise(1.0), after.noise(1.0));
  if (r2(with) > r2(without) + least) {
    if (seen_r2(with) > seen_r2(without)) return false;
    loss += seen_misfit(without, with, true).log_likelihood(floor.cell_variance) -
            seen_misfit(with, with, true).log_likelihood(floor.cell_variance);
  }
  return loss < floor.limits->diagnosis.tie;
}

}  // namespace hookeye
