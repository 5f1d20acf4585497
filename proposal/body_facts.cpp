#include "proposal/body_facts.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <optional>

#include "meshing/tet_mesh.h"
#include "proposal/text_table.h"
#include "proposal/words.h"

namespace hookeye {
namespace {

constexpr double kPlane = 0.004;  ///< of the diagonal: a layer that means the plane in it
constexpr double kEnd = 0.05;     ///< of the length, where an end is not flat

SurfaceMesh boundary_of(const TetMesh& mesh) {
  SurfaceMesh out;
  out.X = mesh.X;
  for (Eigen::Index i = 0; i < mesh.boundary.cols(); ++i)
    out.triangles.push_back({mesh.boundary(0, i), mesh.boundary(1, i), mesh.boundary(2, i)});
  return out;
}

double area_of(const SurfaceMesh& surface, const std::array<int, 3>& t) {
  const Vector3d a = surface.X.col(t[0]), b = surface.X.col(t[1]), c = surface.X.col(t[2]);
  return 0.5 * (b - a).cross(c - a).norm();
}

double volume_of(const SurfaceMesh& surface) {
  const Vector3d origin = surface.X.rowwise().mean();
  double sum = 0;
  for (const auto& t : surface.triangles) {
    const Vector3d a = surface.X.col(t[0]) - origin, b = surface.X.col(t[1]) - origin,
                   c = surface.X.col(t[2]) - origin;
    sum += a.dot(b.cross(c)) / 6;
  }
  return std::abs(sum);
}

/// The axis of the largest spread, each triangle weighing its area; the box's longest side where
/// that is within ten degrees, or where the spreads are much alike.
Vector3d longest_axis(const BodyFacts& body) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Vector3d mean = Vector3d::Zero();
  double area = 0;
  const auto middle = [&](const std::array<int, 3>& t) -> Vector3d {
    return (body.surface.X.col(t[0]) + body.surface.X.col(t[1]) + body.surface.X.col(t[2])) / 3;
  };
  for (const auto& t : body.surface.triangles) {
    const double a = area_of(body.surface, t);
    mean += a * middle(t), area += a;
  }
  mean /= area > 0 ? area : 1;
  for (const auto& t : body.surface.triangles) {
    const Vector3d d = middle(t) - mean;
    spread += area_of(body.surface, t) * d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solved(spread);
  int side = 0;
  (body.high - body.low).maxCoeff(&side);
  const Vector3d along = Vector3d::Unit(side), own = solved.eigenvectors().col(2);
  const bool alike = solved.eigenvalues()[2] < 1.3 * solved.eigenvalues()[1];
  if (alike || std::abs(own.dot(along)) > std::cos(10 * EIGEN_PI / 180)) return along;
  return own.dot(along) < 0 ? Vector3d(-own) : own;
}

}  // namespace

double BodyFacts::length_along(const Vector3d& direction) const {
  const Eigen::RowVectorXd along = direction.transpose() * surface.X;
  return along.maxCoeff() - along.minCoeff();
}

BodyFacts body_facts(const std::filesystem::path& file, bool is_volume) {
  BodyFacts body;
  body.file = file;
  body.is_volume = is_volume;
  if (is_volume) {
    std::vector<std::string> said;
    const TetMesh mesh = read_volume(file, {file.string()}, &said);
    for (const auto& [name, faces] : mesh.boundary_groups) body.groups.push_back(name);
    body.surface = boundary_of(mesh);
  } else {
    body.surface = read_surface(file);
  }
  if (body.surface.triangles.empty())
    throw InputError({file.string()}, "there is no triangle in it", "a closed surface");
  body.low = body.surface.X.rowwise().minCoeff();
  body.high = body.surface.X.rowwise().maxCoeff();
  body.volume = volume_of(body.surface);
  body.axis = longest_axis(body);
  return body;
}

EndRegion end_region(const BodyFacts& body, const Vector3d& direction) {
  EndRegion end;
  end.normal = direction;
  const Eigen::RowVectorXd along = direction.transpose() * body.surface.X;
  const double length = along.maxCoeff() - along.minCoeff();
  const auto cut_at = [&](double depth) {
    const double from = along.maxCoeff() - depth;
    end.point = direction * from;
    end.area = 0;
    for (const auto& t : body.surface.triangles)
      if (along[t[0]] >= from && along[t[1]] >= from && along[t[2]] >= from)
        end.area += area_of(body.surface, t);
  };
  cut_at(kPlane * body.diagonal());
  end.flat = end.area >= 0.2 * body.volume / length;
  if (!end.flat) cut_at(kEnd * length);
  return end;
}

std::optional<Vector3d> direction_in(const std::string& text) {
  std::string bare = lower(trimmed(text));
  if (bare.size() == 1 || (bare.size() == 2 && (bare[0] == '+' || bare[0] == '-'))) {
    const size_t axis = std::string("xyz").find(bare.back());
    if (axis == std::string::npos) return {};
    return (bare[0] == '-' ? -1.0 : 1.0) * Vector3d::Unit(static_cast<Eigen::Index>(axis));
  }
  if (bare.size() > 2 && bare.front() == '[' && bare.back() == ']')
    bare = bare.substr(1, bare.size() - 2);
  const auto parts = between_commas(bare);
  if (parts.size() != 3) return {};
  Vector3d out;
  for (int i = 0; i < 3; ++i) {
    const auto value = number_in(parts[static_cast<size_t>(i)], false);
    if (!value) return {};
    out[i] = *value;
  }
  if (out.norm() == 0) return {};
  return out.normalized();
}

std::string end_name(const Vector3d& direction) {
  for (int i = 0; i < 3; ++i)
    if (std::abs(direction[i]) > 1 - 1e-12)
      return std::string(direction[i] > 0 ? "+" : "-") + "xyz"[i];
  return fmt::format("{:.5g},{:.5g},{:.5g}", direction.x() + 0.0, direction.y() + 0.0,
                     direction.z() + 0.0);
}

}  // namespace hookeye
