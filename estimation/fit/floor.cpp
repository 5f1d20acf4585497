#include "estimation/fit/floor.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "capture_io/distributions.h"
#include "meshing/extent.h"

namespace hookeye {

namespace {

/// Monomials of a cell's place up to `degree`, over the field's extent.
Eigen::VectorXd monomials(const FlowField& flow, const FlowCell& cell, int degree) {
  const auto& first = flow.cells.front().centre_px;
  const double x = (cell.centre_px.x() - first.x()) / 300.0;
  const double y = (cell.centre_px.y() - first.y()) / 300.0;
  Eigen::VectorXd out((degree + 1) * (degree + 2) / 2);
  int k = 0;
  for (int n = 0; n <= degree; ++n)
    for (int i = 0; i <= n; ++i) out[k++] = std::pow(x, n - i) * std::pow(y, i);
  return out;
}

struct SmoothPart {
  double explained = 0.0;  ///< of |r|^2
  double by_motion = 0.0;  ///< of that, what brightness alone does not explain
  double numbers = 0.0;
  Eigen::VectorXd coefficients;  ///< three of every monomial
};

/// The basis of a cell's motion and brightness: 3 x numbers.
Eigen::MatrixXd basis_of(const FlowField& flow, const FlowCell& cell, int degree) {
  const Eigen::VectorXd phi = monomials(flow, cell, degree);
  Eigen::MatrixXd basis(3, 3 * phi.size());
  for (int k = 0; k < phi.size(); ++k)
    basis.middleCols<3>(3 * k) = phi[k] * Eigen::Matrix3d::Identity();
  return basis;
}

/// What motion and brightness that are polynomials of the place explain of a photo's residual:
/// weight, swelling, placement and exposure are smooth, what a renderer gets wrong is not.
SmoothPart smooth_part(const FlowField& flow, int degree) {
  const int size = 3 * (degree + 1) * (degree + 2) / 2;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
  for (const auto& cell : flow.cells) {
    const Eigen::MatrixXd basis = basis_of(flow, cell, degree);
    A += basis.transpose() * cell.information * basis;
    b += basis.transpose() * (cell.information * cell.estimate);
  }
  const Eigen::VectorXd found = A.completeOrthogonalDecomposition().solve(b);
  const auto brightness = Eigen::seqN(2, size / 3, 3);
  const Eigen::VectorXd b_bright = b(brightness);
  const Eigen::VectorXd bright =
      Eigen::MatrixXd(A(brightness, brightness)).completeOrthogonalDecomposition().solve(b_bright);
  const double explained = b.dot(found);
  return {explained, explained - b_bright.dot(bright), static_cast<double>(size), found};
}

/// The field without its smooth part.
FlowField without_smooth(FlowField flow, const SmoothPart& smooth, int degree) {
  const FlowField whole = flow;  // monomials are over its extent
  for (FlowCell& cell : flow.cells) {
    const Eigen::Vector3d moved = basis_of(whole, cell, degree) * smooth.coefficients;
    cell.estimate -= moved;
    cell.z -=
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(cell.information).operatorSqrt() * moved;
  }
  return flow;
}

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

/// What is left of a photo at rest without what moved. Polynomials take the motion out where the
/// picture is linear in it. Past that the pictures are aligned, and rims and what came into view
/// are no noise: the middle cell speaks for all. (An aligned contour is where it should be,
/// whatever the noise: silhouettes have polynomials alone.)
Left without_motion(const PhotoEvaluation& photo, bool silhouette, int degree) {
  Left left;
  for (const auto& cell : photo.flow.cells) left.r2 += cell.r2, left.count += cell.pixels;
  if (!silhouette && photo.motion_px > kLinearPx)
    return {r2_of_middle_cell(photo.aligned, left.count), left.count};
  const SmoothPart moved = smooth_part(photo.flow, degree);
  // Cells have the residual made linear, which grows with a contour's motion where its pixels have
  // long changed all they can: of those it is the share that is left.
  if (silhouette && left.r2 > 0.0)
    return {photo.r2 * (1.0 - moved.explained / left.r2), photo.count - moved.numbers};
  return {left.r2 - moved.explained, left.count - moved.numbers};
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

/// Highest degree for which a polynomial has a term for so many cells; -1: too few cells.
int degree_for(const FlowField& flow, const FloorLimits& limits) {
  int degree = -1;
  while (degree < limits.most_degree && (degree + 2) * (degree + 3) / 2 * limits.cells_a_term <=
                                            static_cast<int>(flow.cells.size()))
    ++degree;
  return degree;
}

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

}  // namespace

Floor measure_floor(const Scene& scene, const Evaluation& evaluation) {
  Floor floor;
  floor.limits = scene.limits;
  const FloorLimits& limits = scene.limits->floor;
  floor.per_px2 = fall_per_px2(evaluation);
  Left all;
  std::map<std::string, Left> cameras;
  std::map<std::string, MotionAtRest> moved;
  double cells = 0.0, cell_count = 0.0;
  Inflations inflations;
  for (const auto& example : evaluation.examples) {
    if (!is_rest(scene.capture.examples[example.example])) continue;
    std::map<int, std::vector<FlowField>> channels;  // by photo
    const bool as_given = unmoved(scene, example);
    for (const auto& photo : example.photos) {
      const int degree = degree_for(photo.flow, limits);
      if (degree < 0) continue;
      const auto& spec = scene.capture.examples[example.example].photos[photo.photo];
      const bool silhouette = spec.kind == PhotoSpec::Kind::silhouette;
      const Left left = without_motion(photo, silhouette, degree);
      all.add(left);
      cameras[spec.camera].add(left);
      if (as_given && !silhouette) moved[spec.camera].add(photo, degree, left);
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
  if (all.count < limits.least_pixels) return floor;
  floor.chi = all.chi();
  for (const auto& [camera, left] : cameras)
    if (left.count >= limits.least_pixels) floor.by_camera[camera] = left.chi();
  for (const auto& [camera, motion] : moved)
    if (motion.count >= limits.least_pixels && !motion.by_chance(limits.chance))
      floor.moved_at_rest[camera] = motion.fall();
  floor.source = "rest photos";
  floor.cell_inflation = std::max(1.0, inflations.sum / inflations.count);
  if (cell_count > 0.0) floor.cell_variance = std::max(1.0, cells / cell_count);
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
