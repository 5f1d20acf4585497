// Kinds of measurements: measured_kinds.def.
#include <algorithm>
#include <array>
#include <cmath>

#include "capture_io/capture.h"
#include "capture_io/capture_reader.h"

namespace hookeye {

namespace {

constexpr MeasuredKind kKinds[] = {
#define MEASURED(kind, on, key, size, unit, words) {#kind, #on, #key, size, #unit, words},
#include "capture_io/measured_kinds.def"
#undef MEASURED
};

}  // namespace

std::span<const MeasuredKind> measured_kinds() { return kKinds; }

const MeasuredKind& kind_of(const MeasuredSpec& measured) {
  return kKinds[static_cast<size_t>(measured.kind)];
}

bool is_strain_field(const MeasuredSpec& measured) {
  return measured.field && measured.field->strain;
}

bool is_reaction(const MeasuredSpec& measured) {
  const std::string unit = kind_of(measured).unit;
  return unit == "force" || unit == "moment";
}

bool is_on_body(const MeasuredSpec& measured) {
  return measured.kind != MeasuredSpec::Kind::calibration;
}

std::string unit_of(const MeasuredSpec& measured, const Units& units) {
  if (is_strain_field(measured)) return "";
  const std::string unit = kind_of(measured).unit;
  return unit == "force"                     ? units.force
         : unit == "moment"                  ? units.force + " " + units.length
         : unit == "angle"                   ? "degrees"
         : unit == "deviations"              ? "sigma"
         : unit == "strain" || unit == "own" ? ""
                                             : units.length;
}

Eigen::MatrixXd MeasuredSpec::whitened(Eigen::MatrixXd difference) const {
  if (covariance_root.size() > 0)
    return covariance_root.triangularView<Eigen::Lower>().solve(difference);
  for (Eigen::Index i = 0; i < sigma.size(); ++i) difference.row(i) /= sigma[i];
  return difference;
}

}  // namespace hookeye
