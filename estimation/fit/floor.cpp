#include "estimation/fit/floor.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/distributions.h"
#include "estimation/fit/field_floor.h"
#include "estimation/fit/smooth_motion.h"
#include "meshing/extent.h"

namespace hookeye {

namespace {

/// |r|^2 of `pixels` pixels as the middle cell has them, its own motion and brightness out.
double r2_of_middle_cell(const FlowField& flow, double pixels) {
  std::vector<double> variance;
  for (const auto& cell : flow.cells)
    if (cell.pixels > cell.known)
      variance.push_back((cell.r2 - cell.explained) / (cell.pixels - cell.known));
  if (variance.empty()) return pixels;
  const auto middle = variance.begin() + static_cast<std::ptrdiff_t>(variance.size() / 2);
  std::nth_element(variance.begin(), middle, variance.end());
  return pixels * *middle;
}

struct Left {
  double r2 = 0.0, count = 0.0;
  void add(const Left& other) { r2 += other.r2, count += other.count; }
  double chi() const { return std::sqrt(std::max(r2, 0.0) / count); }
};

/// |r|^2 that a mask may be off by: a rim is trusted no further than FloorLimits::rim_px, for what
/// cuts it out shifts all of it alike.
double r2_of_rim(const PhotoEvaluation& photo, const FloorLimits& limits) {
  return limits.rim_px * limits.rim_px * motion_information(photo.flow);
}

/// What is left of a photo at rest without what moved. Polynomials take the motion out where the
/// picture is linear in it. Past that the pictures are aligned, and rims and what came into view
/// are no noise: the middle cell speaks for all. (An aligned contour is where it should be,
/// whatever the noise: silhouettes have polynomials alone.)
Left without_motion(const PhotoEvaluation& photo, bool silhouette, int degree,
                    const FloorLimits& limits) {
  Left left;
  for (const auto& cell : photo.flow.cells) left.r2 += cell.r2, left.count += cell.pixels;
  if (!silhouette && photo.motion_px > kLinearPx)
    return {r2_of_middle_cell(photo.aligned, left.count), left.count};
  const SmoothPart moved = smooth_part(photo.flow, degree);
  // Cells have the residual made linear, which grows with a contour's motion where its pixels have
  // long changed all they can: of those it is the share that is left.
  if (silhouette && left.r2 > 0.0)
    return {
        std::min(photo.r2, photo.r2 * (1.0 - moved.explained / left.r2) + r2_of_rim(photo, limits)),
        photo.count - moved.numbers};
  return {left.r2 - moved.explained, left.count - moved.numbers};
}

/// What no model could take from a photo of a loaded body: what stays once every cell has moved,
/// brightened and sharpened on its own.
Left without_free_motion(const PhotoEvaluation& photo, bool silhouette, const FloorLimits& limits) {
  if (!silhouette) return {photo.free_variance * photo.count, photo.count};
  double all = 0.0, moved = 0.0;
  for (const auto& cell : photo.flow.cells) all += cell.r2, moved += cell.explained;
  const double rough = all > 0.0 ? photo.r2 * (1.0 - moved / all) : photo.r2;
  return {std::min(photo.r2, std::max(rough, 0.0) + r2_of_rim(photo, limits)), photo.count};
}

/// The example's equilibrium is the body as it was given.
bool unmoved(const Scene& scene, const ExampleEvaluation& example) {
  const Matrix3Xd& X = scene.body->mesh.X;
  if (!example.equilibrium || example.equilibrium->q.size() != X.size()) return false;
  return (example.equilibrium->q - X.reshaped()).cwiseAbs().maxCoeff() <
         scene.limits->floor.unmoved * extent(X);
}

/// Smooth motion of photos at rest, and what noise would give of it.
struct MotionAtRest {
  double explained = 0.0, numbers = 0.0, r2 = 0.0, count = 0.0;
  void add(const PhotoEvaluation& photo, int degree, const Left& left) {
    const SmoothPart moved = smooth_part(photo.flow, degree);
    explained += moved.by_motion, numbers += moved.numbers * 2.0 / 3.0;
    r2 += left.r2, count += left.count;
  }
  double noise2() const { return r2 / count; }
  bool by_chance(double probability) const {
    return explained <= chi2_quantile(1.0 - probability, numbers) * noise2();
  }
  double fall() const { return (explained - numbers * noise2()) / count; }
};

/// Sum of the inflations of photos, the channels of each in one entry; and how many they are.
struct Inflations {
  double sum = 0.0, count = 0.0;
  void add(const std::vector<FlowField>& channels) {
    std::vector<const FlowField*> all;
    for (const FlowField& channel : channels) all.push_back(&channel);
    for (const FlowStatistics& one : flow_statistics(all)) sum += one.inflation, count += 1.0;
  }
};

/// Floor::per_px2.
double fall_per_px2(const Evaluation& evaluation) {
  double information = 0.0, pixels = 0.0;
  for (const auto& example : evaluation.examples)
    for (const auto& photo : example.photos)
      for (const auto& cell : photo.flow.cells) {
        if (example.held_out) continue;
        information += 0.5 * (cell.information(0, 0) + cell.information(1, 1));
        pixels += cell.pixels;
      }
  return pixels > 0.0 ? information / pixels : 0.0;
}

struct Lefts {
  Left all;
  std::map<std::string, Left> cameras;
  void add(const std::string& camera, const Left& left) {
    all.add(left);
    cameras[camera].add(left);
  }
  std::map<std::string, double> by_camera(const FloorLimits& limits) const {
    std::map<std::string, double> out;
    for (const auto& [camera, left] : cameras)
      if (left.count >= limits.least_pixels) out[camera] = left.chi();
    return out;
  }
};

const PhotoSpec& spec_of(const Scene& scene, const PhotoEvaluation& photo) {
  return scene.capture.examples[photo.example].photos[photo.photo];
}

bool is_silhouette(const Scene& scene, const PhotoEvaluation& photo) {
  return spec_of(scene, photo).kind == PhotoSpec::Kind::silhouette;
}

/// Of fitted photos of the loaded body. Noise and what a renderer gets wrong are a camera's in all
/// its photos alike; where the model is far off, cells still hold motion that is not theirs alone.
/// So that photo of a camera speaks which keeps least.
Lefts left_by_free_motion(const Scene& scene, const Evaluation& evaluation) {
  std::map<std::string, Left> counts;
  std::map<std::string, double> least;
  for (const auto& example : evaluation.examples) {
    if (example.held_out || is_rest(scene.capture.examples[example.example])) continue;
    for (const auto& photo : example.photos) {
      if (smooth_degree(photo.flow, scene.limits->floor) < 0 || photo.count <= 0.0) continue;
      const Left left =
          without_free_motion(photo, is_silhouette(scene, photo), scene.limits->floor);
      const std::string& camera = spec_of(scene, photo).camera;
      const double variance = left.r2 / left.count;
      const auto [at, first] = least.emplace(camera, variance);
      if (!first) at->second = std::min(at->second, variance);
      counts[camera].add(left);
    }
  }
  Lefts out;
  for (const auto& [camera, left] : counts)
    out.add(camera, {least.at(camera) * left.count, left.count});
  return out;
}

/// Of cells' standardised estimates. Noise that was told too large leaves less than 1; what photos
/// keep beyond noise that was told rightly is rough, and cells tell themselves what of it they see.
double variance_of_noise(double chi) { return std::min(1.0, chi * chi); }

/// False: they have too few pixels.
bool of_rest_photos(const Scene& scene, const Evaluation& evaluation, Floor& floor) {
  const FloorLimits& limits = scene.limits->floor;
  Lefts lefts;
  std::map<std::string, MotionAtRest> moved;
  double cells = 0.0, cell_count = 0.0;
  Inflations inflations;
  for (const auto& example : evaluation.examples) {
    if (!is_rest(scene.capture.examples[example.example])) continue;
    std::map<int, std::vector<FlowField>> channels;  // by photo
    const bool as_given = unmoved(scene, example);
    for (const auto& photo : example.photos) {
      const int degree = smooth_degree(photo.flow, limits);
      if (degree < 0) continue;
      const std::string& camera = spec_of(scene, photo).camera;
      const bool silhouette = is_silhouette(scene, photo);
      const Left left = without_motion(photo, silhouette, degree, limits);
      lefts.add(camera, left);
      if (as_given && !silhouette) moved[camera].add(photo, degree, left);
      // Cells are judged after the motion that the registration found, however rough, is out.
      const SmoothPart aligned = smooth_part(photo.aligned, degree);
      cells -= aligned.explained;
      cell_count -= aligned.numbers;
      for (const auto& cell : photo.aligned.cells)
        cells += cell.z.squaredNorm(), cell_count += cell.known;
      // A photo that is too bright all over is no noise that is correlated from cell to cell.
      channels[photo.photo].push_back(without_smooth(photo.aligned, aligned, degree));
    }
    for (const auto& [photo, fields] : channels) inflations.add(fields);
  }
  if (lefts.all.count < limits.least_pixels) return false;
  floor.chi = lefts.all.chi();
  floor.by_camera = lefts.by_camera(limits);
  for (const auto& [camera, motion] : moved)
    if (motion.count >= limits.least_pixels && !motion.by_chance(limits.chance))
      floor.moved_at_rest[camera] = motion.fall();
  floor.source = "rest photos";
  floor.cell_inflation = std::max(1.0, inflations.sum / inflations.count);
  floor.cell_variance = variance_of_noise(floor.chi);
  if (cell_count > 0.0) floor.cell_variance = std::max(floor.cell_variance, cells / cell_count);
  return true;
}

}  // namespace

Floor measure_floor(const Scene& scene, const Evaluation& evaluation) {
  if (evaluation.seen() == Evaluation::Seen::fields) return field_floor(scene, evaluation);
  Floor floor;
  floor.limits = scene.limits;
  floor.per_px2 = fall_per_px2(evaluation);
  const FloorLimits& limits = scene.limits->floor;
  const Lefts free = left_by_free_motion(scene, evaluation);
  const bool told = free.all.count >= limits.least_pixels;
  const bool rest = of_rest_photos(scene, evaluation, floor);
  // Stills of one video, or a texture that is the photo itself, repeat their own noise: they keep
  // less than was told, and less than the loaded photos.
  const double most = floor.chi * limits.at;
  if (rest && !(told && most < 1.0 && most < free.all.chi())) return floor;
  if (rest) floor.copies = floor.chi;
  if (!told) return floor;
  floor.chi = free.all.chi();
  floor.cell_variance = variance_of_noise(floor.chi);
  floor.by_camera = free.by_camera(limits);
  floor.source = "loaded photos";
  return floor;
}

double measured_weight(const Floor& floor) { return floor.cell_inflation; }

double measured_weight(const Scene& scene, const Evaluation& evaluation) {
  return measured_weight(measure_floor(scene, evaluation));
}

double renderers_err_by(const Floor& floor) {
  const FloorLimits& limits = floor.limits->floor;
  return std::max(limits.err_share * std::max(0.0, floor.chi * floor.chi - 1.0),
                  limits.trusted_px * limits.trusted_px * floor.per_px2);
}

}  // namespace hookeye
