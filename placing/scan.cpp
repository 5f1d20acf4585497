#include "placing/scan.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "meshing/extent.h"
#include "meshing/triangle_tree.h"

namespace hookeye {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;

/// Points of a scan with normals, in the body's frame as told.
struct Cloud {
  Matrix3Xd x, n;
  double extent = 0.0;
  Vector3d middle = Vector3d::Zero();
  size_t size() const { return static_cast<size_t>(x.cols()); }
  Cloud thinned(size_t count) const {
    Cloud out = *this;
    if (count >= size()) return out;
    out.x.resize(3, Eigen::Index(count)), out.n.resize(3, Eigen::Index(count));
    for (size_t i = 0; i < count; ++i) {
      const auto from = Eigen::Index(i * size() / count);
      out.x.col(Eigen::Index(i)) = x.col(from), out.n.col(Eigen::Index(i)) = n.col(from);
    }
    return out;
  }
};

/// Spread evenly over the scan's area: a corner that is meshed finely does not count more.
Cloud cloud_of(const SurfaceMesh& scan, const ToldPlacement& told, double scale, size_t count) {
  std::vector<double> up_to;
  double area = 0.0;
  for (const auto& t : scan.triangles) {
    const Vector3d a = scan.X.col(t[0]), b = scan.X.col(t[1]), c = scan.X.col(t[2]);
    area += 0.5 * (b - a).cross(c - a).norm();
    up_to.push_back(area);
  }
  std::mt19937 random(1);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  Cloud out;
  out.x.resize(3, Eigen::Index(count)), out.n.resize(3, Eigen::Index(count));
  for (size_t i = 0; i < count; ++i) {
    const auto found = std::upper_bound(up_to.begin(), up_to.end(), uniform() * area);
    const auto& t = scan.triangles[std::min<size_t>(static_cast<size_t>(found - up_to.begin()),
                                                    scan.triangles.size() - 1)];
    const Vector3d a = scan.X.col(t[0]), b = scan.X.col(t[1]), c = scan.X.col(t[2]);
    const double r = std::sqrt(uniform()), s = uniform();
    const Vector3d x = scale * ((1.0 - r) * a + r * (1.0 - s) * b + r * s * c);
    out.x.col(Eigen::Index(i)) = told.R.transpose() * (x - told.t);
    out.n.col(Eigen::Index(i)) = told.R.transpose() * (b - a).cross(c - a).normalized();
  }
  out.middle = out.x.rowwise().mean();
  out.extent = hookeye::extent(scale * scan.X);
  return out;
}

/// A point of the scan and the plane of the surface it belongs to.
struct Match {
  Eigen::Index point;
  Vector3d on_body, normal;  ///< of the body, before the motion
};

struct Laid {
  Isometry3d motion = Isometry3d::Identity();
  double misfit = INFINITY;  ///< of the nearest share of the points [length]
};

class Laying {
 public:
  Laying(const PlacedBody& body, double floor)
      : body_(body), floor_(floor), tree_(body.surface->X, body.surface->triangles) {
    for (const auto& t : body.surface->triangles) {
      const Vector3d a = body.surface->X.col(t[0]), b = body.surface->X.col(t[1]),
                     c = body.surface->X.col(t[2]);
      normals_.push_back((b - a).cross(c - a).normalized());
    }
  }

  /// By point the distance to the surface that faces as the point does: elsewhere infinite.
  std::vector<double> distances(const Cloud& cloud, const Isometry3d& motion,
                                std::vector<Match>* matches) const {
    constexpr double kFaces = 0.3;  // cosine: normals of a scan are rough
    const Isometry3d back = motion.inverse();
    std::vector<double> out;
    for (Eigen::Index i = 0; i < cloud.x.cols(); ++i) {
      const detail::Hit hit = tree_.nearest(back * cloud.x.col(i));
      const auto& t = body_.surface->triangles[static_cast<size_t>(hit.triangle)];
      const Vector3d& normal = normals_[static_cast<size_t>(hit.triangle)];
      const bool faces = !(normal.dot(back.linear() * cloud.n.col(i)) < kFaces);
      out.push_back(faces ? hit.distance : INFINITY);
      Vector3d on_body = Vector3d::Zero();
      for (int k = 0; k < 3; ++k) on_body += hit.weights[k] * body_.surface->X.col(t[k]);
      if (matches) matches->push_back({i, on_body, normal});
    }
    return out;
  }

  PoseTerms terms(const Cloud& cloud, const std::vector<Match>& matches) const {
    PoseTerms out;
    out.count = static_cast<int>(matches.size());
    out.middle = body_.middle;
    out.term = [this, &cloud, &matches](int i, const Isometry3d& pose, double* r, double* J) {
      const Match& one = matches[static_cast<size_t>(i)];
      const Vector3d normal = pose.linear() * one.normal;
      const Vector3d off = pose * one.on_body - cloud.x.col(one.point);
      r[0] = normal.dot(off);
      if (!J) return true;
      Eigen::Map<Eigen::Matrix<double, 1, 6>> by(J, 1, 6);
      by = normal.transpose() * point_jacobian(pose, body_.middle, one.on_body);
      by.leftCols<3>() += normal.cross(off).transpose();  // the plane turns, too
      return true;
    };
    return out;
  }

  /// Points count up to `reach` times the median of the distances.
  static std::vector<Match> near(const std::vector<double>& distances,
                                 const std::vector<Match>& all, double limit) {
    std::vector<Match> out;
    for (size_t i = 0; i < all.size(); ++i)
      if (distances[i] <= limit) out.push_back(all[i]);
    return out;
  }
  double limit_of(std::vector<double> distances) const {
    constexpr double kReach = 4.0;
    return std::max(kReach * quantile(std::move(distances), 0.5), floor_);
  }

  Laid settle(const Cloud& cloud, const Isometry3d& start, int rounds) const {
    Laid best{start, INFINITY};
    Isometry3d now = start;
    int worse = 0;
    for (int round = 0; round <= rounds; ++round) {
      std::vector<Match> all;
      const std::vector<double> off = distances(cloud, now, &all);
      const double left = misfit(off);
      if (left < 0.999 * best.misfit)
        best = {now, left}, worse = 0;
      else if (++worse > 3)
        break;
      if (round == rounds) break;
      double limit = limit_of(off);
      // Before it lies, most points may face another way: distance alone has to do.
      if (!std::isfinite(limit)) limit = body_.extent;
      const std::vector<Match> kept = near(off, all, limit);
      if (kept.size() < 10) break;
      const PoseFit fit = fit_pose(now, terms(cloud, kept), 0.0, 3);
      if (!fit.good) break;
      now = fit.pose;
    }
    return best;
  }

  /// Root mean square of the distances, each cut at a twentieth of the body.
  double misfit(const std::vector<double>& distances) const {
    const double most = 0.05 * body_.extent;
    double squares = 0.0;
    for (const double d : distances) squares += std::pow(std::min(d, most), 2);
    return std::sqrt(squares / std::max<double>(1.0, double(distances.size())));
  }

  static double quantile(std::vector<double> values, double share) {
    const auto at = values.begin() + static_cast<long>(share * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  }

 private:
  const PlacedBody& body_;
  double floor_;
  detail::TriangleTree tree_;
  std::vector<Vector3d> normals_;
};

/// Wrong units show in the size; a part of the body is smaller, a stand beside it makes it larger.
void check_size(const Cloud& cloud, const PlacedBody& body, const Place& place) {
  constexpr double kSmall = 0.08, kLarge = 5.0;
  const double ratio = cloud.extent / body.extent;
  if (ratio >= kSmall && ratio <= kLarge) return;
  throw InputError(place,
                   fmt::format("the scan is {:.3g} {} across, the body {:.3g}", cloud.extent,
                               body.length, body.extent),
                   "--scan-unit says in which unit the scan is (mm, cm, m, um); else it is taken "
                   "for the capture's. A scan with much around the body is cut to the body first");
}

std::vector<Isometry3d> laying_starts(const Cloud& cloud, const PlacedBody& body) {
  std::vector<Isometry3d> all{Isometry3d::Identity()};
  // Principal axes of both, and the told turn, each with all ways to lay a cube's axes.
  const Vector3d mean = cloud.middle;
  const Matrix3Xd from_mean = cloud.x.colwise() - mean;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(from_mean * from_mean.transpose());
  Matrix3d axes = solver.eigenvectors().rowwise().reverse();
  if (axes.determinant() < 0.0) axes.col(2) *= -1.0;
  for (const Matrix3d& base : {axes, body.axes})
    for (const Matrix3d& turn : cube_turns()) {
      Isometry3d start = Isometry3d::Identity();
      start.linear() = base * turn * body.axes.transpose();
      start.translation() = mean - start.linear() * body.middle;
      all.push_back(start);
    }
  return all;
}

void sort_laid(const PlacedBody& body, std::vector<Laid>* found) {
  constexpr double kSameTurn = 0.05, kSameShift = 0.02;
  std::erase_if(*found, [](const Laid& one) { return !std::isfinite(one.misfit); });
  std::stable_sort(found->begin(), found->end(),
                   [](const Laid& a, const Laid& b) { return a.misfit < b.misfit; });
  std::vector<Laid> kept;
  for (const Laid& one : *found)
    if (std::none_of(kept.begin(), kept.end(), [&](const Laid& other) {
          return !apart(one.motion, other.motion, body.middle, kSameTurn, kSameShift * body.extent);
        }))
      kept.push_back(one);
  *found = std::move(kept);
}

/// Share of the body's area whose nearest points of the scan are near.
double covered_share(const Laying& laying, const Cloud& cloud, const Isometry3d& motion,
                     const PlacedBody& body, double limit) {
  std::vector<Match> all;
  const std::vector<double> off = laying.distances(cloud, motion, &all);
  const std::vector<Match> on = Laying::near(off, all, limit);
  if (on.empty()) return 0.0;
  // A cell of the size that holds a few points where the scan covers the body.
  double area = 0.0;
  for (const auto& t : body.surface->triangles) {
    const Vector3d a = body.surface->X.col(t[0]);
    area += 0.5 * (body.surface->X.col(t[1]) - a).cross(body.surface->X.col(t[2]) - a).norm();
  }
  const double cell = std::sqrt(8.0 * area / double(cloud.size()));
  const auto cells = [&](const auto& points) {
    std::vector<std::array<long, 3>> out;
    for (const Vector3d& x : points)
      out.push_back(
          {std::lround(x.x() / cell), std::lround(x.y() / cell), std::lround(x.z() / cell)});
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  };
  std::vector<Vector3d> met, whole;
  for (const Match& one : on) met.push_back(one.on_body);
  const Cloud surface = cloud_of(*body.surface, {}, 1.0, cloud.size());
  for (Eigen::Index i = 0; i < surface.x.cols(); ++i) whole.push_back(surface.x.col(i));
  return std::min(1.0, double(cells(met).size()) / double(cells(whole).size()));
}

}  // namespace

ScanFit place_by_scan(const SurfaceMesh& scan, const Place& place, const ToldPlacement& told,
                      const PlacedBody& body, const ScanOptions& options) {
  constexpr size_t kFewPoints = 400, kSomePoints = 1500, kKept = 4;
  constexpr double kAsWell = 1.2;       // times the misfit
  constexpr double kOtherTurn = 0.1;    // [rad]
  constexpr double kOtherShift = 0.05;  // of the body's diameter
  if (scan.triangles.size() < 20)
    throw InputError(place, fmt::format("the scan has {} triangles", scan.triangles.size()),
                     "a meshed scan of the body or of a part of it");
  const Cloud cloud = cloud_of(scan, told, options.scale, options.most_points);
  check_size(cloud, body, place);
  const Laying laying(body, 1e-4 * body.extent);
  std::vector<Laid> found;
  const std::vector<Isometry3d> all = laying_starts(cloud, body);
  const Cloud few = cloud.thinned(kFewPoints), some = cloud.thinned(kSomePoints);
  for (size_t i = 0; i < all.size(); ++i) {
    found.push_back(laying.settle(few, all[i], 30));
    if (options.progress) options.progress(i + 1, all.size());
  }
  sort_laid(body, &found);
  if (found.size() > 2 * kKept) found.resize(2 * kKept);
  for (Laid& one : found) one = laying.settle(some, one.motion, 40);
  sort_laid(body, &found);
  if (found.size() > kKept) found.resize(kKept);
  for (Laid& one : found) one = laying.settle(cloud, one.motion, 30);
  sort_laid(body, &found);
  std::vector<Laid> fitting;
  for (const Laid& one : found) {
    const bool other = std::all_of(fitting.begin(), fitting.end(), [&](const Laid& known) {
      return apart(one.motion, known.motion, body.middle, kOtherTurn, kOtherShift * body.extent);
    });
    if (other && one.misfit <= kAsWell * found.front().misfit + 1e-4 * body.extent)
      fitting.push_back(one);
  }
  std::stable_sort(fitting.begin(), fitting.end(), [](const Laid& a, const Laid& b) {
    return angle_of(a.motion) < angle_of(b.motion);
  });
  ScanFit out;
  Placing& placing = out.placing;
  placing.motion = fitting.front().motion;
  std::vector<Match> matches;
  const std::vector<double> off = laying.distances(cloud, placing.motion, &matches);
  const double limit = std::min(laying.limit_of(off), 0.05 * body.extent);
  const std::vector<Match> kept = Laying::near(off, matches, limit);
  double squares = 0.0;
  for (size_t i = 0; i < off.size(); ++i)
    if (off[i] <= limit) squares += off[i] * off[i];
  out.used = double(kept.size()) / double(cloud.size());
  out.covered = covered_share(laying, cloud, placing.motion, body, limit);
  placing.misfit = std::sqrt(squares / std::max<double>(1.0, double(kept.size())));
  placing.misfit_unit = body.length;
  for (size_t i = 1; i < fitting.size(); ++i)
    placing.others.push_back({fitting[i].motion, fitting[i].misfit});
  const double sigma = std::max(placing.misfit, 1e-6 * body.extent);
  set_errors(information_of(placing.motion, laying.terms(cloud, kept), 0.0) / (sigma * sigma), body,
             &placing);
  warn_of_others(body, &placing);
  if (out.used < 0.5)
    placing.warnings.push_back(
        fmt::format("{:.0f} % of the scan's points lie on the body: another body, another unit, or "
                    "much around it; look at the place before it is believed",
                    100.0 * out.used));
  return out;
}

}  // namespace hookeye
