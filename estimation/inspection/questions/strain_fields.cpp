// Are the strains of a field of the measure, the unit and the axes that the capture says? The
// displacements beside them in the file tell; where there are none, the first guess does, whatever
// the modulus.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "capture_io/field_start.h"
#include "estimation/inspection/field_motion.h"
#include "estimation/inspection/question.h"
#include "estimation/inspection/strain_readings.h"
#include "estimation/model/field_points.h"

namespace hookeye::inspection {

namespace {

/// Sums over the numbers that are known, in standard deviations.
struct Against {
  double seen2 = 0.0, expected2 = 0.0, product = 0.0, count = 0.0;
  /// rms of what is left; `scaled`: whatever factor is on what is expected.
  double left(bool scaled) const {
    if (count == 0.0) return 0.0;
    const double left2 = scaled && expected2 > 0.0
                             ? seen2 - product * std::max(product, 0.0) / expected2
                             : seen2 - 2.0 * product + expected2;
    return std::sqrt(std::max(left2, 0.0) / count);
  }
  double factor() const { return expected2 > 0.0 ? product / expected2 : 0.0; }
  double cosine() const {
    return seen2 > 0.0 && expected2 > 0.0 ? product / std::sqrt(seen2 * expected2) : 0.0;
  }
};

Against against(const MeasuredSpec& measured, const VectorXd& expected) {
  Against out;
  for (Eigen::Index i = 0; i < expected.size(); ++i) {
    if (!std::isfinite(expected[i])) continue;
    const Eigen::Index k = i / measured.field->components;
    const double sigma = measured.sigma[i] / std::sqrt(measured.field->alike[k]);
    const double seen = measured.value[i] / sigma, there = expected[i] / sigma;
    out.seen2 += seen * seen, out.expected2 += there * there, out.product += seen * there;
    out.count += 1.0;
  }
  return out;
}

/// A unit that is this many times another; "": none is near.
std::string strain_unit_of(double factor, double close) {
  const std::pair<double, const char*> units[] = {
      {1e2, "percent"}, {1e3, "millistrain"}, {1e6, "microstrain"}};
  for (const auto& [of, name] : units)
    if (std::abs(std::log(factor / of)) < std::log(close)) return name;
  return "";
}

/// The reading that explains best, where the told one, which is the first, does much worse.
const StrainReading* better(const MeasuredSpec& measured, const std::vector<StrainReading>& all,
                            bool scaled, const InspectionOptions& options) {
  const double told = against(measured, all.front().expected).left(scaled);
  const StrainReading* best = nullptr;
  double least = options.left_by_reading * told;
  for (const StrainReading& one : all) {
    const Against here = against(measured, one.expected);
    if (here.cosine() < options.sure_reading || here.left(scaled) >= least) continue;
    best = &one, least = here.left(scaled);
  }
  return told > options.sigmas_of_reading ? best : nullptr;
}

std::string said_of(const std::string& file, const StrainReading& reading, const char* by) {
  return fmt::format("the strains of {} agree with {} where {}", file, by, reading.is);
}

/// By the displacements in the same file. True: something is said, or they are right.
bool by_displacements(Sight& sight, const MeasuredSpec& measured, Warnings& warnings) {
  const FieldSpec& field = *measured.field;
  const char* by = "the displacements beside them";
  if (!start_of(measured).empty() && !sight.coarse()) return false;
  const auto all = out_of_displacements(
      start_of(measured).empty() ? sight.scene().body->mesh : mesh_of_field(sight, measured), field,
      sight.options());
  if (all.empty() || against(measured, all.front().expected).count < 3.0 * field.components)
    return false;
  const Against told = against(measured, all.front().expected);
  if (const std::string unit = strain_unit_of(told.factor(), sight.options().close_unit);
      !unit.empty()) {
    warnings.say(measured.place,
                 fmt::format("the strains of {} are {:.3g} times those of {}", field.told,
                             told.factor(), by),
                 fmt::format("`strain_unit: {}`", unit));
    return true;
  }
  if (told.factor() > 0.0 &&
      !strain_unit_of(1.0 / told.factor(), sight.options().close_unit).empty()) {
    warnings.say(measured.place,
                 fmt::format("the strains of {} are 1/{:.3g} of those of {}", field.told,
                             1.0 / told.factor(), by),
                 "`strain_unit: fraction`, or the unit that the file has");
    return true;
  }
  std::vector<StrainReading> readings = all;
  for (const StrainReading& other : other_readings(field, all.front()))
    if (other.is != all.front().is) readings.push_back(other);
  if (const StrainReading* one = better(measured, readings, false, sight.options()))
    warnings.say(measured.place, said_of(field.told, *one, by), one->right);
  return true;
}

void by_first_guess(Sight& sight, int e, const MeasuredSpec& measured, Warnings& warnings) {
  const int start = start_index(sight.scene(), measured);
  const auto unknown = [&](int load) {
    return sight.guess(load)->turned || sight.load_doubted(load);
  };
  const VectorXd u = guessed_motion(sight, start, e).first_order;
  if (u.size() == 0 || unknown(e) || (start >= 0 && unknown(start))) return;
  const StrainReading right{strains_to_first_order(measured, mesh_of_field(sight, measured), u),
                            "they are as told", ""};
  if (right.expected.size() == 0) return;
  const auto readings = other_readings(*measured.field, right);
  if (const StrainReading* one = better(measured, readings, true, sight.options()))
    warnings.say(measured.place, said_of(measured.field->told, *one, "the first guess"),
                 one->right);
}

}  // namespace

void ask_strain_fields(Sight& sight, Warnings& warnings) {
  for (size_t i = 0; i < sight.scene().capture.examples.size(); ++i) {
    const int e = static_cast<int>(i);
    for (const MeasuredSpec& measured : sight.example(e).measured)
      if (is_strain_field(measured) && !(is_rest(sight.example(e)) && start_of(measured).empty()) &&
          !by_displacements(sight, measured, warnings) && sight.coarse())
        by_first_guess(sight, e, measured, warnings);
  }
}

}  // namespace hookeye::inspection
