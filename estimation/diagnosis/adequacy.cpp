#include "estimation/diagnosis/adequacy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/distributions.h"
#include "estimation/fit/field_floor.h"
#include "estimation/fit/smooth_motion.h"

namespace hookeye {

namespace {

/// One channel of a photo.
struct Moved {
  const PhotoEvaluation* photo;
  bool held_out;
  double explained, numbers;  ///< fall of |r|^2 by smooth motion, and its degrees of freedom
  double noise2;              ///< of each of these, correlation from cell to cell counted
  double bias2;               ///< fall that the computation's own errors may bring
  double information;         ///< motion_information()
};

/// Variance of a smooth signature in what is rough.
double noise2_of(const PhotoEvaluation& photo, bool silhouette, int degree, const Floor& floor) {
  // Aligned rims have no motion left that could tell their noise.
  const FlowField& field = silhouette ? photo.flow : photo.aligned;
  const FlowStatistics rough =
      flow_statistics(without_smooth(field, smooth_part(field, degree), degree));
  return std::max(rough.variance * rough.inflation,
                  silhouette ? 0.0 : floor.cell_variance * floor.cell_inflation);
}

std::vector<Moved> all_moved(const Scene& scene, const Evaluation& evaluation, const Floor& floor,
                             const VectorXd& mesh_step) {
  std::vector<Moved> out;
  const FloorLimits& limits = scene.limits->floor;
  for (const auto& example : evaluation.examples)
    for (const auto& photo : example.photos) {
      const int degree = smooth_degree(photo.flow, limits);
      if (degree < 0) continue;
      const bool silhouette = scene.capture.examples[photo.example].photos[photo.photo].kind ==
                              PhotoSpec::Kind::silhouette;
      const SmoothPart smooth = smooth_part(photo.flow, degree);
      const double information = motion_information(photo.flow);
      if (smooth.numbers_of_motion < 1.0 || information <= 0.0) continue;
      const double trusted = silhouette ? limits.rim_px : limits.moved_px;
      double bias2 = trusted * trusted * information;
      if (mesh_step.size() > 0 && photo.sums.JtJ.rows() == mesh_step.size())
        bias2 += mesh_step.dot(photo.sums.JtJ * mesh_step);
      out.push_back({&photo, example.held_out, std::max(smooth.by_motion, 0.0),
                     smooth.numbers_of_motion, noise2_of(photo, silhouette, degree, floor), bias2,
                     information});
    }
  return out;
}

/// Of one field; `chance` that the noise alone takes it beyond most_px.
MotionLeft moved_in_field(const MeasuredSpec& spec, const MeasuredEvaluation& field,
                          const Floor& floor, bool floor_is_own, const VectorXd& mesh_step,
                          double chance) {
  const FieldSpec& told = *spec.field;
  const SmoothField smooth = smooth_field(told, whole_residual(spec, field), floor.limits->floor);
  const double numbers = told.numbers();
  const double variance = smooth.rest.squaredNorm() / std::max(1.0, numbers - smooth.numbers);
  const double noise2 = std::max(variance * told.inflation(smooth.rest / std::sqrt(variance)),
                                 floor_is_own ? floor.cell_variance * floor.cell_inflation : 1.0);
  double bias2 = 0.0;
  if (mesh_step.size() > 0 && field.J.cols() == mesh_step.size())
    bias2 = (field.J * mesh_step).squaredNorm();
  // |r|^2 that one length of displacement (or a strain of 1) all over would bring.
  const double information = numbers / (told.components * told.sigma * told.sigma);
  const double noise = std::sqrt(noise2 * chi2_quantile(1.0 - chance, smooth.numbers));
  return {field.example,
          field.index,
          false,
          std::sqrt(smooth.explained / information),
          (noise + std::sqrt(bias2)) / std::sqrt(information),
          true};
}

std::vector<MotionLeft> moved_in_fields(const Scene& scene, const Evaluation& evaluation,
                                        const Floor& floor, const VectorXd& mesh_step) {
  double count = 0.0;
  for (const auto& example : evaluation.examples)
    for (const auto& field : example.measured) count += field.is_field();
  std::vector<MotionLeft> out;
  for (const auto& example : evaluation.examples)
    for (const auto& field : example.measured) {
      if (!field.is_field()) continue;
      out.push_back(moved_in_field(scene.capture.examples[example.example].measured[field.index],
                                   field, floor, evaluation.seen() == Evaluation::Seen::fields,
                                   mesh_step, scene.limits->floor.chance / count));
      out.back().held_out = example.held_out;
    }
  return out;
}

}  // namespace

std::vector<MotionLeft> motions_left(const Scene& scene, const Evaluation& evaluation,
                                     const Floor& floor, const VectorXd& mesh_step) {
  const std::vector<Moved> all = all_moved(scene, evaluation, floor, mesh_step);
  std::vector<MotionLeft> out;
  for (const Moved& one : all) {
    const double chance = scene.limits->floor.chance / static_cast<double>(all.size());
    const double noise = std::sqrt(one.noise2 * chi2_quantile(1.0 - chance, one.numbers));
    const MotionLeft motion{one.photo->example, one.photo->photo, one.held_out,
                            std::sqrt(one.explained / one.information),
                            (noise + std::sqrt(one.bias2)) / std::sqrt(one.information)};
    if (out.empty() || out.back().example != motion.example || out.back().photo != motion.photo)
      out.push_back(motion);
    else if (motion.times() > out.back().times())
      out.back() = motion;
  }
  for (const MotionLeft& one : moved_in_fields(scene, evaluation, floor, mesh_step))
    out.push_back(one);
  return out;
}

const MotionLeft* most_moved(const std::vector<MotionLeft>& motions) {
  const auto most = std::max_element(
      motions.begin(), motions.end(),
      [](const MotionLeft& one, const MotionLeft& other) { return one.times() < other.times(); });
  return most == motions.end() || most->times() <= 1.0 ? nullptr : &*most;
}

std::string in_words(const MotionLeft& motion, const Scene& scene) {
  const ExampleSpec& example = scene.capture.examples[motion.example];
  if (motion.field && is_strain_field(example.measured[motion.photo]))
    return fmt::format(
        "the strain field of '{}' still shows the body strained smoothly otherwise, by {:.2g} "
        "millistrain where noise and mesh leave {:.2g} at most",
        example.name, 1e3 * motion.px, 1e3 * motion.most_px);
  if (motion.field)
    return fmt::format(
        "the field of '{}' still shows the body moved smoothly, by {:.2g} {} where noise and mesh "
        "leave {:.2g} at most",
        example.name, motion.px, scene.capture.units.length, motion.most_px);
  return fmt::format(
      "the {} of camera '{}' in '{}' still shows the body moved smoothly, by {:.2g} px where "
      "noise, renderer and mesh leave {:.2g} at most",
      example.photos[motion.photo].kind == PhotoSpec::Kind::silhouette ? "silhouette" : "photo",
      example.photos[motion.photo].camera, example.name, motion.px, motion.most_px);
}

}  // namespace hookeye
