#include "estimation/diagnosis/diagnosis_sums.h"

#include <algorithm>

#include "estimation/evaluation/gram.h"

namespace hookeye {

namespace {

/// Fields count as photos do, each number of theirs as a cell: by their effective share. Where no
/// example has a photo, what is seen are fields.
void add_fields(const Evaluation& evaluation, const Floor& floor, DiagnosisSums& out) {
  const bool seen = evaluation.seen() == Evaluation::Seen::fields;
  for (const auto& example : evaluation.examples)
    for (const auto& field : example.measured) {
      if (!field.is_field()) continue;
      const Eigen::MatrixXd JtJ = field.J.transpose() * field.J;
      const VectorXd Jtr = field.J.transpose() * field.r;
      const double r2 = field.r.squaredNorm();
      if (seen) {
        (example.held_out ? out.held_r2 : out.photo_r2) += r2;
        (example.held_out ? out.held_count : out.photo_count) += field.size();
        NormalEquations& sums = example.held_out ? out.seen_held_out : out.seen;
        sums.JtJ += JtJ, sums.Jtr += Jtr;
      }
      if (example.held_out) continue;
      const double w = field.effective / field.size();
      out.effective.H += w * JtJ;
      out.effective.s += w * Jtr;
      out.effective.r2 += w * r2;
      out.effective.count += w * field.size();
      out.noise += w * w * field.inflation * JtJ;
      out.null_noise += w * w * floor.cell_inflation * JtJ;
    }
}

}  // namespace

DiagnosisSums diagnosis_sums(const Evaluation& evaluation, const Floor& floor) {
  DiagnosisSums out;
  const int m = evaluation.columns;
  out.effective.H.setZero(m, m);
  out.effective.s.setZero(m);
  out.effective.floor2 = floor.cell_variance;
  out.pixel_floor2 = floor.chi * floor.chi;
  out.noise.setZero(m, m);
  out.null_noise.setZero(m, m);
  int photos = 0;
  for (NormalEquations* sums : {&out.seen, &out.seen_held_out})
    sums->JtJ.setZero(m, m), sums->Jtr.setZero(m);
  for (const auto& example : evaluation.examples) {
    const auto statistics = photo_statistics(example.photos);
    for (size_t k = 0; k < example.photos.size(); ++k) {
      const auto& photo = example.photos[k];
      (example.held_out ? out.held_r2 : out.photo_r2) += photo.linear_r2;
      (example.held_out ? out.held_count : out.photo_count) += photo.count;
      NormalEquations& seen = example.held_out ? out.seen_held_out : out.seen;
      if (photo.count > 0.0) seen.JtJ += photo.sums.JtJ, seen.Jtr += photo.sums.Jtr;
      if (example.held_out) continue;
      const FlowStatistics& flow = statistics[k];
      if (flow.count == 0.0) continue;
      ++photos;
      out.whiteness_p = std::min(out.whiteness_p, flow.whiteness_p);
      const double w = flow.effective / flow.count;
      out.effective.H += w * photo.sums.JtJ;
      out.effective.s += w * photo.sums.Jtr;
      out.effective.r2 += w * flow.variance * flow.count;
      out.effective.count += w * flow.count;
      out.noise += w * w * flow.inflation * photo.sums.JtJ;
      out.null_noise += w * w * floor.cell_inflation * photo.sums.JtJ;
    }
  }
  out.whiteness_p = std::min(1.0, photos * out.whiteness_p);
  add_fields(evaluation, floor, out);
  const double photo_noise =
      std::max(out.effective.floor2, out.effective.r2 / std::max(out.effective.count, 1.0));
  out.measured.H = out.effective.H / photo_noise;
  out.measured.s = out.effective.s / photo_noise;
  for (const auto& example : evaluation.examples) {
    if (example.held_out) continue;
    for (const auto& measured : example.measured) {
      if (measured.is_field()) continue;
      const Eigen::MatrixXd JtJ = measured.J.transpose() * measured.J;
      const double r2 = measured.r.squaredNorm();
      const auto add = [&](EffectiveSums& sums, double deviation2) {
        sums.H += deviation2 * JtJ;
        sums.s += deviation2 * measured.J.transpose() * measured.r;
        sums.r2 += deviation2 * r2;
        sums.count += measured.size();
      };
      // One noise holds for all sums: a sensor's deviation counts as much as a cell's at the floor.
      const double cell2 = out.effective.floor2;
      add(out.effective, cell2);
      add(out.measured, 1.0);
      out.measured_count += measured.size();
      out.noise += cell2 * cell2 * std::max(1.0, r2 / measured.size()) * JtJ;
      out.null_noise += cell2 * cell2 * JtJ;
    }
  }
  out.fitted = normal_equations(evaluation, false);
  if (out.photo_count + out.held_count > 0.0) return out;  // else sensors are all there is
  out.seen = out.fitted, out.seen_held_out = normal_equations(evaluation, true);
  for (const auto& example : evaluation.examples)
    for (const auto& measured : example.measured) {
      (example.held_out ? out.held_r2 : out.photo_r2) += measured.r.squaredNorm();
      (example.held_out ? out.held_count : out.photo_count) += measured.size();
    }
  return out;
}

double measured_r2(const Evaluation& evaluation, const VectorXd* step) {
  double sum = 0.0;
  for (const auto& example : evaluation.examples)
    for (const auto& measured : example.measured)
      if (!example.held_out && !measured.is_field())
        sum += (step ? VectorXd(measured.r + measured.J * *step) : measured.r).squaredNorm();
  return sum;
}

double without_base(const EffectiveSums& sums, int base, const DiagnosisLimits& limits) {
  if (base == 0) return sums.r2;
  const VectorXd s = sums.s.head(base);
  const Eigen::MatrixXd H = sums.H.topLeftCorner(base, base);
  const double gain = s.dot(pseudo_inverse(H) * s);
  return std::max(sums.r2 - gain, (1.0 - limits.base_most) * sums.r2);
}

}  // namespace hookeye
