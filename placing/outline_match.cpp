// Contours matched as points to lines across them (RAPiD: Harris, Stennett, BMVC 1990; both ways,
// as otherwise a small model would hide anywhere on a large outline). The rim's points are taken
// anew after each step, since other points of the body come to lie on it.
#include "placing/outline_match.h"

#include <algorithm>
#include <cmath>

namespace hookeye {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;

constexpr size_t kMostPulls = 600;   // of a photo, one way: neighbours say the same
constexpr double kLeastSlope = 0.5;  // where two outlines are as near a distance has no direction

size_t stride_of(size_t count) {
  return std::max<size_t>(1, (count + kMostPulls - 1) / kMostPulls);
}

Vector2d at(int pixel, int width) { return {double(pixel % width), double(pixel / width)}; }

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

OutlineMatch::OutlineMatch(const Scene& scene, const PlacedBody& body,
                           std::vector<Outline> outlines)
    : body_(body), outlines_(std::move(outlines)), view_(scene) {}

Camera OutlineMatch::seen_by(const Outline& outline, const Isometry3d& motion) const {
  Camera camera = outline.view;
  camera.t += camera.R * motion.translation();
  camera.R = camera.R * motion.linear();
  return camera;
}

void OutlineMatch::pull_photo(int photo, const Isometry3d& motion, std::vector<RimPull>* out) {
  const Outline& seen = outlines_[static_cast<size_t>(photo)];
  const int width = seen.view.width, height = seen.view.height;
  const Camera camera = seen_by(seen, motion);
  const SurfaceMesh& surface = *body_.surface;
  const inspection::BodyPicture picture = view_.look(camera, surface.X, {});
  const auto covered = std::count(picture.outline_of.begin(), picture.outline_of.end(), 1);
  if (covered == 0 || covered == static_cast<long>(picture.outline_of.size())) return;
  const SignedDistance model(picture.outline_of, width, height);
  std::vector<int> rim = rim_of(picture.outline_of, width, height, seen.counts);
  std::erase_if(rim, [&](int i) { return picture.triangle[static_cast<size_t>(i)] < 0; });
  if (rim.empty()) return;
  std::vector<Vector3d> points;
  for (const int i : rim) {
    const auto& t =
        surface.triangles[static_cast<size_t>(picture.triangle[static_cast<size_t>(i)])];
    const Eigen::Vector2d uv = picture.uv[static_cast<size_t>(i)].cast<double>();
    points.push_back((1.0 - uv.sum()) * surface.X.col(t[0]) + uv.x() * surface.X.col(t[1]) +
                     uv.y() * surface.X.col(t[2]));
  }
  const auto pull = [&](size_t k, const Vector2d& slope, double by) {
    if (slope.norm() < kLeastSlope) return;
    out->push_back({photo, points[k], camera.project(points[k]), slope.normalized(), by});
  };
  for (size_t k = 0; k < rim.size(); k += stride_of(rim.size())) {
    const Vector2d p = at(rim[k], width);
    pull(k, seen.distance.slope(p), model.at(p) - seen.distance.at(p));
  }
  const std::vector<int> nearest = nearest_of(rim, width, height);
  for (size_t j = 0; j < seen.rim.size(); j += stride_of(seen.rim.size())) {
    const Vector2d c = at(seen.rim[j], width);
    const int k = nearest[static_cast<size_t>(seen.rim[j])];
    if (k >= 0) pull(static_cast<size_t>(k), model.slope(c), model.at(c) - seen.distance.at(c));
  }
}

std::vector<RimPull> OutlineMatch::pulls(const Isometry3d& motion) {
  std::vector<RimPull> out;
  for (size_t i = 0; i < outlines_.size(); ++i) pull_photo(static_cast<int>(i), motion, &out);
  return out;
}

PoseTerms OutlineMatch::terms(const std::vector<RimPull>& pulls) const {
  PoseTerms out;
  out.count = static_cast<int>(pulls.size());
  out.middle = body_.middle;
  out.term = [this, &pulls](int i, const Isometry3d& pose, double* r, double* J) {
    const RimPull& one = pulls[static_cast<size_t>(i)];
    const Outline& outline = outlines_[static_cast<size_t>(one.photo)];
    Camera::Jacobian3 by_point;
    const Vector2d seen = outline.view.project(pose * one.point, &by_point, nullptr);
    if (!seen.allFinite()) return false;
    r[0] = (one.across.dot(seen - one.seen) - one.by) * outline.px;
    if (J)
      Eigen::Map<Eigen::Matrix<double, 1, 6>>(J, 1, 6) =
          outline.px * one.across.transpose() * by_point *
          point_jacobian(pose, body_.middle, one.point);
    return true;
  };
  return out;
}

double OutlineMatch::misfit(const std::vector<RimPull>& pulls) const {
  if (pulls.empty()) return INFINITY;
  double squares = 0.0;
  for (const RimPull& one : pulls) {
    const Outline& outline = outlines_[static_cast<size_t>(one.photo)];
    squares += std::pow(std::min(std::abs(one.by), 0.4 * outline.spread) * outline.px, 2);
  }
  return std::sqrt(squares / double(pulls.size()));
}

OutlineMatch::Settled OutlineMatch::settle(const Isometry3d& start, int rounds) {
  constexpr double kStill = 0.02;  // [px of the small photo]
  Settled best{start, INFINITY};
  Isometry3d now = start;
  int worse = 0;
  for (int round = 0; round <= rounds; ++round) {
    const std::vector<RimPull> all = pulls(now);
    const double left = misfit(all);
    if (left < best.misfit)
      best = {now, left}, worse = 0;
    else if (all.empty() || ++worse > 3)
      break;
    if (round == rounds) break;
    std::vector<double> sizes;
    for (const RimPull& one : all)
      sizes.push_back(std::abs(one.by) * outlines_[static_cast<size_t>(one.photo)].px);
    // What is far beyond the middle is another body, a hand, a stand.
    const double loss = std::max(2.0 * median(sizes), 1.0);
    const PoseFit fit = fit_pose(now, terms(all), loss, 8);
    if (!fit.good) break;
    const double step = (fit.pose * body_.middle - now * body_.middle).norm() +
                        Eigen::AngleAxisd(now.linear().transpose() * fit.pose.linear()).angle() *
                            0.5 * body_.extent;
    const double px = outlines_.front().view.length_per_px(now * body_.middle);
    now = fit.pose;
    if (step < kStill * px) break;
  }
  return best;
}

Isometry3d OutlineMatch::centred(const Isometry3d& motion) const {
  Isometry3d out = motion;
  for (int round = 0; round < 3; ++round) {
    Matrix3d sum = Matrix3d::Zero();
    Vector3d pull = Vector3d::Zero();
    const Vector3d middle = out * body_.middle;
    for (const Outline& outline : outlines_) {
      const Ray ray = outline.view.ray(outline.centre);
      if (!ray.direction.allFinite()) continue;
      const Matrix3d across = Matrix3d::Identity() - ray.direction * ray.direction.transpose();
      sum += across;
      pull += across * (ray.origin - middle);
    }
    out.pretranslate(Vector3d(sum.completeOrthogonalDecomposition().pseudoInverse() * pull));
    if (outlines_.size() > 1 || !outlines_.front().view.model->central()) continue;
    // One camera: as far as the body is as large.
    const Outline& outline = outlines_.front();
    double squares = 0.0, count = 0.0;
    const Vector2d centre = outline.view.project(out * body_.middle);
    for (Eigen::Index i = 0; i < body_.surface->X.cols(); ++i) {
      const Vector2d seen = outline.view.project(out * body_.surface->X.col(i));
      if (seen.allFinite()) squares += (seen - centre).squaredNorm(), count += 1.0;
    }
    if (count == 0.0 || !(squares > 0.0)) continue;
    // Vertices lie on the surface, most of them inside of the outline as its pixels do.
    const double larger = std::sqrt(squares / count) / outline.spread;
    const Vector3d from = out * body_.middle - outline.view.centre();
    out.pretranslate(Vector3d((larger - 1.0) * from));
  }
  return out;
}

}  // namespace hookeye
