// What an evaluation says in single figures.
#include <cmath>

#include "estimation/evaluation/evaluation.h"

namespace hookeye {

double PhotoEvaluation::chi() const { return count > 0 ? std::sqrt(r2 / count) : 0.0; }

const ExampleEvaluation* Evaluation::find(int example) const {
  for (const auto& one : examples)
    if (one.example == example) return &one;
  return nullptr;
}

namespace {

double root_mean(const std::vector<ExampleEvaluation>& examples, bool held_out,
                 double PhotoEvaluation::*r2) {
  double sum = 0.0, count = 0.0;
  for (const auto& example : examples)
    if (example.held_out == held_out)
      for (const auto& photo : example.photos) sum += photo.*r2, count += photo.count;
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

/// Root mean square of what is measured: of fields, or of all else.
double root_mean(const std::vector<ExampleEvaluation>& examples, bool held_out, bool fields) {
  double sum = 0.0, count = 0.0;
  for (const auto& example : examples)
    if (example.held_out == held_out)
      for (const auto& measured : example.measured)
        if (measured.is_field() == fields)
          sum += measured.r.squaredNorm(), count += measured.size();
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

}  // namespace

Evaluation::Seen Evaluation::seen() const {
  Seen out = Seen::sensors;
  for (const auto& example : examples) {
    if (!example.photos.empty()) return Seen::photos;
    for (const auto& measured : example.measured)
      if (measured.is_field()) out = Seen::fields;
  }
  return out;
}

double Evaluation::measured_chi(bool held_out) const {
  return root_mean(examples, held_out, false);
}

double Evaluation::field_chi(bool held_out) const { return root_mean(examples, held_out, true); }

double Evaluation::chi(bool held_out) const {
  const Seen what = seen();
  if (what == Seen::photos) return root_mean(examples, held_out, &PhotoEvaluation::r2);
  return root_mean(examples, held_out, what == Seen::fields);
}

double Evaluation::linear_chi(bool held_out) const {
  if (seen() != Seen::photos) return chi(held_out);
  return root_mean(examples, held_out, &PhotoEvaluation::linear_r2);
}

double Evaluation::rms_px(bool held_out) const {
  double sum = 0.0, n = 0.0;
  for (const auto& example : examples)
    if (example.held_out == held_out)
      for (const auto& photo : example.photos) {
        const double cells = static_cast<double>(photo.flow.cells.size());
        sum += cells * std::pow(photo.flow.rms_px(), 2);
        n += cells;
      }
  return n > 0.0 ? std::sqrt(sum / n) : 0.0;
}

double Evaluation::motion_px() const {
  double sum = 0.0, n = 0.0;
  for (const auto& example : examples)
    for (const auto& photo : example.photos) {
      sum += photo.count * photo.motion_px * photo.motion_px;
      n += photo.count;
    }
  return n > 0.0 ? std::sqrt(sum / n) : 0.0;
}

std::vector<FlowStatistics> photo_statistics(const std::vector<PhotoEvaluation>& photos) {
  std::vector<FlowStatistics> out;
  for (size_t begin = 0, end = 0; begin < photos.size(); begin = end) {
    std::vector<const FlowField*> channels;
    for (; end < photos.size() && photos[end].photo == photos[begin].photo; ++end)
      channels.push_back(&photos[end].flow);
    for (FlowStatistics& one : flow_statistics(channels)) out.push_back(one);
  }
  return out;
}

}  // namespace hookeye
