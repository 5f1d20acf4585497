#include "estimation/diagnosis/residual_noise.h"

#include <algorithm>
#include <cmath>

#include "estimation/evaluation/gram.h"
#include "estimation/fit/smooth_motion.h"

namespace hookeye {

namespace {

using Kind = SeenPart::Kind;

SeenPart of_photo(const PhotoSpec& spec, const PhotoEvaluation& photo, const CondensedPhoto& sums,
                  const FlowStatistics& statistics) {
  SeenPart out;
  out.kind = spec.kind == PhotoSpec::Kind::silhouette ? Kind::silhouette : Kind::textured;
  out.camera = spec.camera;
  out.count = statistics.count;
  out.variance = statistics.variance;
  out.effective = statistics.effective;
  out.information = motion_information(photo.flow);
  out.pixels = photo.count;
  out.pixel_r2 = sums.r2;
  out.H = sums.JtJ;
  out.s = sums.Jtr;
  return out;
}

SeenPart of_numbers(const MeasuredEvaluation& measured, const MeasuredEvaluation& sums) {
  SeenPart out;
  out.kind = measured.is_field() ? Kind::field : Kind::sensor;
  out.count = measured.size();
  out.effective = measured.is_field() ? measured.effective : out.count;
  out.variance = out.count > 0.0 ? measured.r.squaredNorm() / out.count : 0.0;
  out.H = sums.J.transpose() * sums.J;
  out.s = sums.J.transpose() * sums.r;
  return out;
}

/// Of a camera's floor over that of all, 1 at least.
double own_floor2(const std::string& camera, const Floor& floor) {
  const auto own = floor.by_camera.find(camera);
  if (own == floor.by_camera.end() || floor.chi <= 0.0) return 1.0;
  return std::max(1.0, std::pow(own->second / floor.chi, 2));
}

ResidualNoise::Part noise_of_photo(const SeenPart& part, const Floor& floor) {
  if (part.count <= 0.0) return {};
  const double least = std::min(1.0, floor.cell_variance);
  const double floor2 = floor.cell_variance * own_floor2(part.camera, floor);
  ResidualNoise::Part out;
  out.variance = std::max(least, std::min(floor2, part.variance));
  out.count = part.effective;
  if (part.kind == Kind::silhouette) {
    const double px = floor.limits->floor.rim_px;
    out.count *= out.variance / (out.variance + px * px * part.information / part.count);
  } else {
    out.count = std::min(out.count, part.count / floor.cell_inflation);
  }
  out.share = out.count / part.count;
  out.pixel_floor2 = floor.chi * floor.chi * own_floor2(part.camera, floor);
  return out;
}

void add(const SeenPart& part, const ResidualNoise::Part& noise, EffectiveSums& out) {
  if (part.count <= 0.0 || noise.count <= 0.0) return;
  out.H += noise.share / noise.variance * part.H;
  out.s += noise.share / noise.variance * part.s;
  out.r2 += part.variance * noise.count / noise.variance;
  out.count += noise.count;
}

}  // namespace

std::vector<SeenPart> seen_parts(const Fitted& fitted, const Evaluation* sums) {
  const Evaluation& own = fitted.evaluation;
  const Evaluation& summed = sums ? *sums : own;
  std::vector<SeenPart> out;
  for (size_t e = 0; e < own.examples.size(); ++e) {
    const ExampleEvaluation &example = own.examples[e], &there = summed.examples[e];
    const auto& specs = fitted.form.scene->capture.examples[example.example].photos;
    const auto statistics = photo_statistics(example.photos);
    const size_t before = out.size();
    for (size_t k = 0; k < example.photos.size(); ++k)
      out.push_back(of_photo(specs[example.photos[k].photo], example.photos[k],
                             there.photos[k].sums, statistics[k]));
    for (size_t k = 0; k < example.measured.size(); ++k)
      out.push_back(of_numbers(example.measured[k], there.measured[k]));
    for (size_t k = before; k < out.size(); ++k) out[k].held_out = example.held_out;
  }
  return out;
}

ResidualNoise estimate_noise(const std::vector<SeenPart>& reference, const Floor& floor) {
  ResidualNoise out;
  for (const SeenPart& part : reference) switch (part.kind) {
      case Kind::textured:
      case Kind::silhouette:
        out.parts.push_back(noise_of_photo(part, floor));
        break;
      case Kind::field:
        out.parts.push_back(
            {floor.cell_variance, part.effective, part.effective / part.count, 1.0});
        break;
      case Kind::sensor:
        out.parts.push_back({1.0, part.count, 1.0, 1.0});
        break;
    }
  return out;
}

namespace {

/// What all pixels have over their floor, with the weights of the sums.
double excess_of_pixels(const std::vector<SeenPart>& parts, const ResidualNoise& noise,
                        bool held_out) {
  double out = 0.0;
  for (size_t i = 0; i < parts.size() && i < noise.parts.size(); ++i) {
    const ResidualNoise::Part& of = noise.parts[i];
    if (parts[i].held_out == held_out && parts[i].count > 0.0)
      out += of.share / of.variance * (parts[i].pixel_r2 - of.pixel_floor2 * parts[i].pixels);
  }
  return out;
}

/// Cells show motion and brightness of whole pixels; rims and blur are in the sums over pixels,
/// too, and more may be removed from those than cells have. What the columns remove of all that
/// pixels have over their floor is the share of what they remove of the cells'; noise stays.
double with_what_columns_remove(const EffectiveSums& sums, double excess) {
  const double removed = sums.s.dot(pseudo_inverse(sums.H) * sums.s);
  const double noise = std::min(sums.r2, sums.floor2 * sums.count);
  const double share = removed >= excess ? 1.0 : removed / excess;
  return std::max(sums.r2, removed + noise + (1.0 - share) * (sums.r2 - noise));
}

}  // namespace

std::vector<EffectiveSums> in_noise(const std::vector<SeenPart>& parts, const ResidualNoise& noise,
                                    bool held_out) {
  const Eigen::Index columns = parts.empty() ? 0 : parts.front().s.size();
  std::vector<EffectiveSums> out(2);
  for (EffectiveSums& group : out) group.H.setZero(columns, columns), group.s.setZero(columns);
  for (size_t i = 0; i < parts.size() && i < noise.parts.size(); ++i)
    if (parts[i].held_out == held_out)
      add(parts[i], noise.parts[i], out[parts[i].kind == Kind::sensor ? 1 : 0]);
  if (columns > 0)
    out[0].r2 = with_what_columns_remove(out[0], excess_of_pixels(parts, noise, held_out));
  return out;
}

}  // namespace hookeye
