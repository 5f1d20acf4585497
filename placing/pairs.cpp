// Points seen in cameras: object-space iteration (Lu, Hager, Mjolsness, PAMI 2000) from starts all
// around, which takes any camera that has rays, then least squares in pixels. Wrong pairs are those
// that leave the least median of squares (Rousseeuw 1984).
#include "placing/pairs.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "capture_io/capture_reader.h"
#include "meshing/triangle_tree.h"

namespace hookeye {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Subset = std::vector<size_t>;

constexpr double kUnseen = 1e6;  // [px] of a point that the camera cannot see

struct Sighting {
  const Camera* camera;
  Ray ray;
  Matrix3d across;  ///< I - d d^T of the ray
  Vector2d pixel;
  Vector3d point;
};

struct Candidate {
  Isometry3d motion = Isometry3d::Identity();
  double rms = INFINITY;  ///< [px], over u and v together
};

class Solver {
 public:
  Solver(std::vector<Sighting> all, const PlacedBody& body, double sigma)
      : all_(std::move(all)), body_(body), sigma_(sigma) {
    turns_.push_back(Matrix3d::Identity());
    for (const Matrix3d& turn : cube_turns())
      if (!turn.isIdentity()) turns_.push_back(body.axes * turn * body.axes.transpose());
  }
  size_t size() const { return all_.size(); }

  Vector2d off(size_t i, const Isometry3d& motion) const {
    return all_[i].camera->project(motion * all_[i].point) - all_[i].pixel;
  }

  PoseTerms terms(const Subset& of) const {
    PoseTerms out;
    out.count = static_cast<int>(of.size());
    out.size = 2;
    out.middle = body_.middle;
    out.term = [this, of](int i, const Isometry3d& pose, double* r, double* J) {
      const Sighting& one = all_[of[static_cast<size_t>(i)]];
      Camera::Jacobian3 by_point;
      const Vector2d seen = one.camera->project(pose * one.point, &by_point, nullptr);
      if (!seen.allFinite()) return false;
      Eigen::Map<Vector2d>(r, 2).noalias() = (seen - one.pixel) / sigma_;
      if (J)
        Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>>(J, 2, 6) =
            by_point * point_jacobian(pose, body_.middle, one.point) / sigma_;
      return true;
    };
    return out;
  }

  double rms(const Subset& of, const Isometry3d& motion) const {
    double squares = 0.0;
    for (const size_t i : of) {
      const double off_px = off(i, motion).squaredNorm();
      squares += std::isfinite(off_px) ? off_px : kUnseen * kUnseen;
    }
    return std::sqrt(squares / (2.0 * double(of.size())));
  }

  /// Local minima, the best first; those that are the same place once.
  std::vector<Candidate> solve(const Subset& of) const {
    std::vector<Candidate> found;
    for (const Matrix3d& turn : turns_) {
      const Isometry3d start = in_space(of, turn);
      if (rms(of, start) >= kUnseen / 100.0) continue;
      const PoseFit fit = fit_pose(start, terms(of), 0.0, 50);
      if (!fit.good) continue;
      const bool known = std::any_of(found.begin(), found.end(), [&](const Candidate& one) {
        return !apart(one.motion, fit.pose, body_.middle, 0.01, 0.01 * body_.extent);
      });
      if (!known) found.push_back({fit.pose, rms(of, fit.pose)});
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Candidate& a, const Candidate& b) { return a.rms < b.rms; });
    return found;
  }

  bool degenerate(const Subset& of) const {
    constexpr double kThin = 0.01;  // width over length of a line
    Eigen::Matrix3Xd X(3, static_cast<Eigen::Index>(of.size()));
    for (size_t i = 0; i < of.size(); ++i) X.col(Eigen::Index(i)) = all_[of[i]].point;
    X.colwise() -= X.rowwise().mean().eval();
    const Eigen::JacobiSVD<Eigen::Matrix3Xd> svd(X);
    return of.size() < 3 || !(svd.singularValues()[1] > kThin * svd.singularValues()[0]);
  }

 private:
  /// Points to the feet of their perpendiculars on the rays, again and again.
  Isometry3d in_space(const Subset& of, Matrix3d R) const {
    Matrix3d sum = Matrix3d::Zero();
    for (const size_t i : of) sum += all_[i].across;
    // Along parallel rays nothing moves.
    const Matrix3d inverse = sum.completeOrthogonalDecomposition().pseudoInverse();
    Vector3d mean = Vector3d::Zero();
    for (const size_t i : of) mean += all_[i].point / double(of.size());
    Isometry3d pose = Isometry3d::Identity();
    constexpr int kRounds = 60;
    for (int round = 0; round < kRounds; ++round) {
      const Vector3d t0 = mean - R * mean;  // turned on the spot
      Vector3d pull = Vector3d::Zero();
      for (const size_t i : of)
        pull += all_[i].across * (all_[i].ray.origin - R * all_[i].point - t0);
      const Vector3d t = t0 + inverse * pull;
      pose.linear() = R, pose.translation() = t;
      Matrix3d mixed = Matrix3d::Zero();
      Vector3d feet = Vector3d::Zero();
      std::vector<Vector3d> foot;
      for (const size_t i : of) {
        const Sighting& one = all_[i];
        const Vector3d x = R * one.point + t;
        // Behind a central camera its mirror image counts: the point has to come to the front.
        const double along = (x - one.ray.origin).dot(one.ray.direction);
        const double kept = one.camera->model->central() ? std::abs(along) : along;
        foot.push_back(one.ray.origin + kept * one.ray.direction);
        feet += foot.back() / double(of.size());
      }
      for (size_t i = 0; i < of.size(); ++i)
        mixed += (foot[i] - feet) * (all_[of[i]].point - mean).transpose();
      const Eigen::JacobiSVD<Matrix3d> svd(mixed, Eigen::ComputeFullU | Eigen::ComputeFullV);
      Vector3d signs = Vector3d::Ones();
      if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) signs.z() = -1.0;
      R = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
    }
    return pose;
  }

  std::vector<Sighting> all_;
  const PlacedBody& body_;
  double sigma_;
  std::vector<Matrix3d> turns_;
};

std::vector<Sighting> sightings(const std::vector<PickedPair>& pairs, const Capture& capture) {
  std::vector<Sighting> out;
  for (const PickedPair& pair : pairs) {
    const auto camera = std::find_if(capture.cameras.begin(), capture.cameras.end(),
                                     [&](const Camera& c) { return c.name == pair.camera; });
    if (camera == capture.cameras.end())
      throw InputError(pair.place, fmt::format("there is no camera `{}`", pair.camera),
                       suggest(pair.camera, names_of(capture.cameras)));
    const auto& p = pair.pixel;
    const bool inside = p.x() >= -0.5 && p.y() >= -0.5 && p.x() <= camera->width - 0.5 &&
                        p.y() <= camera->height - 0.5;
    if (!inside)
      throw InputError(pair.place,
                       fmt::format("pixel ({:g}, {:g}) is not in the picture of camera `{}`", p.x(),
                                   p.y(), pair.camera),
                       fmt::format("0 to {} and 0 to {}: u counts to the right, v down",
                                   camera->width - 1, camera->height - 1));
    const Ray ray = camera->ray(p);
    out.push_back({&*camera, ray, Matrix3d::Identity() - ray.direction * ray.direction.transpose(),
                   p, pair.point});
  }
  return out;
}

void check_points(const std::vector<PickedPair>& pairs, const PlacedBody& body,
                  const Solver& solver, const Subset& all) {
  const Place& place = pairs.back().place;
  std::vector<Vector3d> different;
  for (const PickedPair& pair : pairs)
    if (std::none_of(different.begin(), different.end(), [&](const Vector3d& X) {
          return (X - pair.point).norm() < 1e-6 * body.extent;
        }))
      different.push_back(pair.point);
  if (different.size() < 3)
    throw InputError(place,
                     fmt::format("{} different point{} of the body cannot tell where it lies",
                                 different.size(), different.size() == 1 ? "" : "s"),
                     "three points that lie on no line, better six and more all over the body");
  if (solver.degenerate(all))
    throw InputError(place, "the points of the body lie on one line: it may be turned about it",
                     "add a point beside that line");
}

/// Subsets of `size` of n, all or, where they are many, a fair choice that is always the same.
std::vector<Subset> subsets(size_t n, size_t size) {
  constexpr size_t kMost = 150;
  std::vector<Subset> out;
  std::vector<char> chosen(n, 0);
  std::fill_n(chosen.begin(), size, char{1});
  do {
    Subset one;
    for (size_t i = 0; i < n; ++i)
      if (chosen[i]) one.push_back(i);
    out.push_back(std::move(one));
  } while (out.size() <= kMost && std::prev_permutation(chosen.begin(), chosen.end()));
  if (out.size() <= kMost) return out;
  out.clear();
  std::mt19937 random(1);
  Subset order(n);
  std::iota(order.begin(), order.end(), size_t{0});
  while (out.size() < kMost) {
    for (size_t i = 0; i < size; ++i) std::swap(order[i], order[i + random() % (n - i)]);
    out.emplace_back(order.begin(), order.begin() + static_cast<long>(size));
  }
  return out;
}

/// The place that the most pairs agree on: four give it, the median of all judges it.
Isometry3d agreed_place(const Solver& solver) {
  Isometry3d best = Isometry3d::Identity();
  double least = INFINITY;
  for (const Subset& four : subsets(solver.size(), 4)) {
    if (solver.degenerate(four)) continue;
    for (const Candidate& one : solver.solve(four)) {
      std::vector<double> off;
      for (size_t i = 0; i < solver.size(); ++i) {
        const double px = solver.off(i, one.motion).norm();
        off.push_back(std::isfinite(px) ? px : kUnseen);
      }
      // The four, or half of all, have to fit.
      const size_t middle = std::max<size_t>(off.size() / 2, 3);
      std::nth_element(off.begin(), off.begin() + static_cast<long>(middle), off.end());
      if (off[middle] < least) least = off[middle], best = one.motion;
    }
  }
  return best;
}

Subset near(const Solver& solver, const Isometry3d& motion, double px) {
  Subset out;
  for (size_t i = 0; i < solver.size(); ++i)
    if (solver.off(i, motion).norm() < px) out.push_back(i);
  return out;
}

/// The pair without which the others agree best.
size_t worst(const Solver& solver, const Subset& all) {
  size_t out = 0;
  double least = INFINITY;
  for (size_t i = 0; i < all.size(); ++i) {
    Subset others = all;
    others.erase(others.begin() + static_cast<long>(i));
    if (solver.degenerate(others)) continue;
    const auto found = solver.solve(others);
    if (!found.empty() && found.front().rms < least) least = found.front().rms, out = all[i];
  }
  return out;
}

[[noreturn]] void refuse(const std::vector<PickedPair>& pairs, const Solver& solver,
                         const Subset& all, double rms, double sigma) {
  const PickedPair& doubtful = pairs[worst(solver, all)];
  throw InputError(
      doubtful.place,
      fmt::format("the pairs do not agree: wherever the body lies, they are off by {:.3g} px (root "
                  "mean square); without this one they agree best",
                  rms),
      fmt::format("pick it anew: camera `{}`, pixel ({:g}, {:g}), point ({:g}, {:g}, {:g}). Are "
                  "points in the body's frame and unit? Picked that roughly: --sigma {:.2g}",
                  doubtful.camera, doubtful.pixel.x(), doubtful.pixel.y(), doubtful.point.x(),
                  doubtful.point.y(), doubtful.point.z(), std::max(rms, 2.0 * sigma)));
}

void warn_of_points_off(const std::vector<PickedPair>& pairs, const PlacedBody& body,
                        Placing* placing) {
  constexpr double kOff = 0.03;  // of the body's diameter
  const detail::TriangleTree tree(body.surface->X, body.surface->triangles);
  for (const PickedPair& pair : pairs) {
    const double off = tree.nearest(pair.point).distance;
    if (off > kOff * body.extent)
      placing->warnings.push_back(fmt::format(
          "{}: point ({:g}, {:g}, {:g}) is {:.3g} {} off the body's surface: points are told in "
          "the "
          "frame and the unit of the body's file",
          pair.place.str(), pair.point.x(), pair.point.y(), pair.point.z(), off, body.length));
  }
}

}  // namespace

PairFit place_by_pairs(const std::vector<PickedPair>& pairs, const Capture& capture,
                       const PlacedBody& body, const PairOptions& options) {
  const double sigma = options.sigma_px;
  const Solver solver(sightings(pairs, capture), body, sigma);
  Subset all(pairs.size());
  std::iota(all.begin(), all.end(), size_t{0});
  check_points(pairs, body, solver, all);
  constexpr double kAgree = 3.0, kFar = 4.0;  // standard deviations
  constexpr size_t kFewest = 5;               // of which one can be told wrong
  Subset used = all;
  auto found = solver.solve(used);
  if (found.empty() || found.front().rms > kAgree * sigma) {
    const double rms = found.empty() ? kUnseen : found.front().rms;
    if (pairs.size() < kFewest) refuse(pairs, solver, all, rms, sigma);
    Isometry3d place = agreed_place(solver);
    for (int i = 0; i < 5; ++i) {
      used = near(solver, place, kFar * std::sqrt(2.0) * sigma);
      if (used.size() < 4 || 2 * used.size() <= all.size() || solver.degenerate(used))
        refuse(pairs, solver, all, rms, sigma);
      place = fit_pose(place, solver.terms(used), 0.0, 50).pose;
    }
    found = solver.solve(used);
    if (found.empty() || found.front().rms > kAgree * sigma) refuse(pairs, solver, all, rms, sigma);
  }
  // Of the places that fit within the noise the one nearest to the told one.
  const double squares = 2.0 * double(used.size()) / (sigma * sigma);
  std::vector<Candidate> fitting;
  for (const Candidate& one : found)
    if (squares * (one.rms * one.rms - found.front().rms * found.front().rms) < 12.0)
      fitting.push_back(one);
  std::stable_sort(fitting.begin(), fitting.end(), [](const Candidate& a, const Candidate& b) {
    return angle_of(a.motion) < angle_of(b.motion);
  });
  PairFit out;
  Placing& placing = out.placing;
  placing.motion = fitting.front().motion;
  placing.misfit = fitting.front().rms, placing.misfit_unit = "px";
  for (size_t i = 1; i < fitting.size(); ++i)
    placing.others.push_back({fitting[i].motion, fitting[i].rms});
  // Picked worse than told: the errors grow with it.
  const double freedom = 2.0 * double(used.size()) - 6.0;
  const double chi2 = squares * placing.misfit * placing.misfit;
  const double grown = freedom > 0.0 ? std::max(1.0, chi2 / freedom) : 1.0;
  set_errors(information_of(placing.motion, solver.terms(used), 0.0) / grown, body, &placing);
  warn_of_others(body, &placing);
  warn_of_points_off(pairs, body, &placing);
  if (freedom <= 2.0)
    placing.warnings.emplace_back(
        "so few pairs hardly check each other: a wrong one would not show; six and more do");
  for (size_t i = 0; i < pairs.size(); ++i) {
    out.off_px.push_back(solver.off(i, placing.motion));
    out.used.push_back(std::find(used.begin(), used.end(), i) != used.end());
    if (!out.used.back())
      placing.warnings.push_back(fmt::format(
          "{}: left out, off by {:.3g} px: camera `{}`, pixel ({:g}, {:g}), point ({:g}, {:g}, "
          "{:g})",
          pairs[i].place.str(), out.off_px.back().norm(), pairs[i].camera, pairs[i].pixel.x(),
          pairs[i].pixel.y(), pairs[i].point.x(), pairs[i].point.y(), pairs[i].point.z()));
  }
  return out;
}

}  // namespace hookeye
