#include "exporters/seen_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "capture_io/field_start.h"
#include "capture_io/strain_field.h"
#include "estimation/evaluation/started_field.h"
#include "estimation/model/field_points.h"
#include "exporters/seen_motion.h"
#include "meshing/extent.h"
#include "render/renderer.h"

namespace hookeye {
namespace {

using detail::MotionCells;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Which triangle of the surface shows at the pixels' centres, and where in it.
Rendering look(Renderer& renderer, const Matrix3Xd& x, const Camera& camera) {
  RenderOptions options;
  options.rays_per_axis = 1;
  options.visibility_rays = 0;
  options.cast_shadows = options.smooth_normals = options.derivatives = false;
  PhotoState state;
  state.camera = camera;
  return renderer.render(x, nullptr, Texture{}, state, options, true);
}

/// A pixel of the photo as it was read, in the whole photo.
Eigen::Vector2d in_whole_photo(const Scene& scene, const std::string& camera,
                               const Eigen::Vector2d& px) {
  const auto reading = scene.readings.find(camera);
  if (reading == scene.readings.end()) return px;
  const PhotoWindow& window = reading->second.window;
  const Eigen::Vector2d corner =
      window.empty() ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(window.x, window.y);
  const double factor = std::ldexp(1.0, reading->second.halvings);
  return ((px + corner).array() + 0.5) * factor - 0.5;
}

/// Points of the body at rest on the grid of a camera's picture.
SeenPoints grid_of(const Body& body, const Scene& scene, const Camera& camera, Renderer& renderer,
                   const BoundaryLocator& locator, const SeenOptions& options) {
  SeenPoints out;
  out.view = camera.name;
  const SurfaceMesh& surface = body.surface.mesh;
  const Rendering rest = look(renderer, surface.X, camera);
  const int step = std::max(1, options.grid_px >> scene.halvings_of(camera.name));
  std::vector<Vector3d> X;
  std::vector<Eigen::Vector2d> px;
  std::vector<double> spacing;
  for (int y = step / 2; y < camera.height; y += step)
    for (int x = step / 2; x < camera.width; x += step) {
      const size_t pixel = static_cast<size_t>(y) * camera.width + x;
      const int triangle = rest.triangle[pixel];
      if (triangle < 0) continue;
      const auto& corners = surface.triangles[static_cast<size_t>(triangle)];
      const Vector3d a = surface.X.col(corners[0]), b = surface.X.col(corners[1]),
                     c = surface.X.col(corners[2]);
      const Eigen::Vector2d uv = rest.uv[pixel].cast<double>();
      X.push_back(a + uv.x() * (b - a) + uv.y() * (c - a));
      px.push_back(in_whole_photo(scene, camera.name, {x, y}));
      spacing.push_back(step * camera.length_per_px(X.back()));
      const Vector3d normal = (b - a).cross(c - a).normalized();
      // To the right in the picture, so that y is up for who looks from outside.
      out.tangents.push_back(
          tangents_of(normal, options.along.value_or(camera.R.row(0).transpose())));
      SurfacePoint point;
      locator.locate(X.back(), &point);
      out.points.push_back(point);
    }
  out.X.resize(3, static_cast<Eigen::Index>(X.size()));
  out.px.resize(2, out.X.cols());
  for (Eigen::Index i = 0; i < out.X.cols(); ++i)
    out.X.col(i) = X[static_cast<size_t>(i)], out.px.col(i) = px[static_cast<size_t>(i)];
  std::nth_element(spacing.begin(), spacing.begin() + static_cast<long>(spacing.size() / 2),
                   spacing.end());
  if (!spacing.empty()) out.spacing = spacing[spacing.size() / 2];
  return out;
}

/// Displacement and strain of the model.
void set_model(const TetMesh& mesh, const VectorXd& q, SeenPoints& out) {
  out.u.resize(3, out.size());
  out.strain.clear();
  for (int i = 0; i < out.size(); ++i) {
    const SurfacePoint& point = out.points[static_cast<size_t>(i)];
    out.u.col(i) = displacement_at(mesh, q, point);
    out.strain.push_back(
        strain_of(gradient_at(mesh, q, point) * out.tangents[static_cast<size_t>(i)]));
  }
  out.apart = Matrix3Xd::Constant(3, out.size(), kNone);
  out.sigma = VectorXd::Constant(out.size(), kNone);
  out.known.assign(static_cast<size_t>(out.size()), 0);
  out.strain_seen.assign(static_cast<size_t>(out.size()), {});
}

/// Only points that `keep` has.
SeenPoints part_of(const SeenPoints& all, const std::vector<int>& keep) {
  SeenPoints out;
  out.view = all.view, out.camera = all.camera, out.spacing = all.spacing;
  out.X = all.X(Eigen::all, keep), out.px = all.px(Eigen::all, keep);
  for (const int i : keep) {
    out.points.push_back(all.points[static_cast<size_t>(i)]);
    out.tangents.push_back(all.tangents[static_cast<size_t>(i)]);
  }
  return out;
}

/// One camera in one state: what shows where.
struct Sightline {
  Sightline(const Body& body, const VectorXd& q, const Camera& of, Renderer& renderer)
      : camera(of),
        x(body.surface.deformed(body.mesh, q)),
        triangles(body.surface.mesh.triangles),
        near(0.02 * extent(body.mesh.X)),
        shown(look(renderer, x, of)) {}
  /// Whether the surface at its pixel is the surface at the point, and the pixel.
  bool sees(const Vector3d& point, Eigen::Vector2d* px) const {
    *px = camera.project(point);
    if (!px->allFinite()) return false;
    const double column = std::round(px->x()), row = std::round(px->y());
    if (column < 0 || row < 0 || column >= camera.width || row >= camera.height) return false;
    const int triangle =
        shown.triangle[static_cast<size_t>(row) * camera.width + static_cast<size_t>(column)];
    if (triangle < 0) return false;
    const auto& c = triangles[static_cast<size_t>(triangle)];
    const Vector3d a = x.col(c[0]);
    const Vector3d normal =
        Vector3d(x.col(c[1]) - x.col(c[0])).cross(Vector3d(x.col(c[2]) - x.col(c[0]))).normalized();
    // Off the plane that shows there: another part of the body hides it.
    return std::abs(normal.dot(point - a)) < near;
  }
  Camera camera;
  Matrix3Xd x;
  const std::vector<std::array<int, 3>>& triangles;
  double near;
  Rendering shown;
};

/// A load case's photos: how each sees the body, and what its cells say.
struct CasePhoto {
  std::string camera;
  Sightline line;
  MotionCells cells = {};
};

std::vector<CasePhoto> photos_of(const Model& model, const ExampleEvaluation& example,
                                 Renderer& renderer) {
  std::vector<CasePhoto> out;
  const auto e = static_cast<size_t>(example.example);
  const auto& states = model.examples[e].photos;
  for (size_t k = 0; k < states.size(); ++k) {
    out.push_back({states[k].camera.name, Sightline(*model.scene->body, example.equilibrium->q,
                                                    states[k].camera, renderer)});
    for (const PhotoEvaluation& photo : example.photos)
      if (photo.photo == static_cast<int>(k) &&
          model.scene->capture.examples[e].photos[k].kind == PhotoSpec::Kind::image)
        out.back().cells.add(photo.flow);
  }
  return out;
}

/// The points of a camera's grid that a load case's photo shows, with what all photos say of them.
SeenPoints seen_by(const SeenPoints& grid, const CasePhoto& own, const std::vector<CasePhoto>& all,
                   const TetMesh& mesh, const VectorXd& q) {
  std::vector<int> keep;
  Eigen::Vector2d px;
  for (int i = 0; i < grid.size(); ++i)
    if (own.line.sees(grid.X.col(i) + displacement_at(mesh, q, grid.points[static_cast<size_t>(i)]),
                      &px))
      keep.push_back(i);
  SeenPoints out = part_of(grid, keep);
  set_model(mesh, q, out);
  for (int i = 0; i < out.size(); ++i) {
    const Vector3d x = out.X.col(i) + out.u.col(i);
    std::vector<std::pair<const Camera*, MotionCells::Motion>> seen;
    for (const CasePhoto& photo : all)
      if (photo.line.sees(x, &px))
        if (const auto motion = photo.cells.at(px)) seen.emplace_back(&photo.line.camera, *motion);
    const detail::SpaceMotion motion = detail::motion_in_space(seen, x);
    if (motion.known == 0) continue;
    out.apart.col(i) = motion.u, out.sigma[i] = motion.sigma;
    out.known[static_cast<size_t>(i)] = motion.known;
  }
  return out;
}

/// What is measured of strains, as Green-Lagrange ones. Small strains are taken for stretches
/// without a turn. Empty: there is no shear.
std::optional<SurfaceStrain> as_green(StrainMeasure measure, const VectorXd& e) {
  if (e.size() < 3) return {};
  Eigen::Matrix2d E, C;
  E << e[0], e[2], e[2], e[1];
  switch (measure) {
    case StrainMeasure::green:
      return SurfaceStrain{e[0], e[1], e[2]};
    case StrainMeasure::hencky: {
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(E);
      C = eigen.eigenvectors() * (2.0 * eigen.eigenvalues()).array().exp().matrix().asDiagonal() *
          eigen.eigenvectors().transpose();
      break;
    }
    case StrainMeasure::engineering: {
      const double x = 1.0 + e[0], y = 1.0 + e[1], shear = x * y * std::sin(2.0 * e[2]);
      C << x * x, shear, shear, y * y;
      break;
    }
    default:
      C = (Eigen::Matrix2d::Identity() + E) * (Eigen::Matrix2d::Identity() + E);
  }
  return SurfaceStrain{0.5 * (C(0, 0) - 1.0), 0.5 * (C(1, 1) - 1.0), 0.5 * C(0, 1)};
}

/// Of a field of strains: the model's over the field's gauge, and the measured ones.
void set_strains(const Model& model, const TetMesh& mesh, const MeasuredSpec& told,
                 const StrainPoints& points, const VectorXd& q, SeenPoints& out) {
  FieldSpec green = *told.field;
  auto strain = std::make_shared<StrainSpec>(*green.strain);
  strain->measure = StrainMeasure::green;
  green.strain = strain;
  const PointStrainer strainer(mesh, green, points, model.placement.linear());
  const int c = told.field->components;
  for (int i = 0; i < out.size(); ++i) {
    const Vector3d e = strainer.at(i, q, nullptr, {}).e;
    out.strain[static_cast<size_t>(i)] = {e[0], e[1], e[2]};
    out.strain_seen[static_cast<size_t>(i)] =
        as_green(told.field->strain->measure, told.value.segment(c * i, c));
  }
}

/// Tangents of a field of displacements: along its own axes where these lie in the surface.
Tangents tangents_in(const FieldSpec& field, const Vector3d& normal, const SeenOptions& options) {
  if (!options.along)
    if (const auto own = tangents_along(normal, field.axes.leftCols<2>())) return *own;
  return tangents_of(normal, options.along.value_or(field.axes.col(0)));
}

/// `mesh`: where the field starts.
SeenPoints seen_in_field(const Model& model, const TetMesh& mesh, const MeasuredSpec& told,
                         const MeasuredEvaluation& measured, const VectorXd& q,
                         const SeenOptions& options) {
  const BoundaryFaces faces(mesh);
  const FieldSpec& field = *told.field;
  const FieldPoints points = field_points(mesh, field);
  SeenPoints out;
  out.view = std::filesystem::path(field.told).stem().string();
  out.camera = false, out.spacing = field.spacing, out.from = start_of(told);
  out.X = points.rest;
  for (Eigen::Index i = 0; i < out.X.cols(); ++i) {
    const SurfacePoint& point = points.at[static_cast<size_t>(i)];
    out.points.push_back(point);
    out.tangents.push_back(points.strain ? points.strain->tangents[static_cast<size_t>(i)]
                                         : tangents_in(field, faces.normal(point), options));
  }
  set_model(mesh, q, out);
  if (points.strain) {
    set_strains(model, mesh, told, *points.strain, q, out);
    return out;
  }
  const Eigen::Matrix3d turn = model.placement.linear();
  const int c = field.components;
  for (int i = 0; i < out.size(); ++i) {
    const VectorXd apart = told.value.segment(c * i, c) - measured.predicted.segment(c * i, c);
    Vector3d in_axes = Vector3d::Zero();
    in_axes.head(c) = apart;
    out.apart.col(i) = turn.transpose() * (field.axes * in_axes);
    out.sigma[i] = field.sigma, out.known[static_cast<size_t>(i)] = c;
  }
  return out;
}

/// Points by cubes of space, to find those about one.
class Neighbours {
 public:
  Neighbours(const SeenPoints& points, double reach) : points_(points), reach_(reach) {
    for (int i = 0; i < points.size(); ++i)
      if (points.has_apart(i)) cubes_[key(cube_of(points.X.col(i)))].push_back(i);
  }
  std::vector<int> about(const Vector3d& X) const {
    std::vector<int> out;
    const Eigen::Vector3i middle = cube_of(X);
    for (int i = 0; i < 27; ++i) {
      const auto found =
          cubes_.find(key(middle + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
      if (found == cubes_.end()) continue;
      for (const int k : found->second)
        if ((points_.X.col(k) - X).norm() <= reach_) out.push_back(k);
    }
    std::sort(out.begin(), out.end());
    return out;
  }

 private:
  Eigen::Vector3i cube_of(const Vector3d& X) const {
    return (X / reach_).array().floor().cast<int>();
  }
  static long key(const Eigen::Vector3i& cube) {
    return (cube.x() * 73856093L) ^ (cube.y() * 19349663L) ^ (cube.z() * 83492791L);
  }
  const SeenPoints& points_;
  double reach_;
  std::unordered_map<long, std::vector<int>> cubes_;
};

/// Strains of the photos: the model's, and the gradient of what the photos add to it in a window.
void set_strain_seen(const TetMesh& mesh, const VectorXd& q, int window, SeenPoints& out) {
  constexpr double kSameSide = 0.7;  // cosine of normals: a window does not go round an edge
  if (!(out.spacing > 0.0)) return;
  const Neighbours neighbours(out, (0.5 * (window - 1) + 0.3) * out.spacing);
  const auto normal = [&](int i) {
    const Tangents& t = out.tangents[static_cast<size_t>(i)];
    return Vector3d(t.col(0)).cross(Vector3d(t.col(1)));
  };
  const size_t least = static_cast<size_t>(window) * window / 3;
  for (int i = 0; i < out.size(); ++i) {
    if (!out.has_apart(i)) continue;
    std::vector<int> about = neighbours.about(out.X.col(i));
    std::erase_if(about, [&](int k) { return normal(k).dot(normal(i)) < kSameSide; });
    if (about.size() < std::max<size_t>(least, 4)) continue;
    const Tangents& T = out.tangents[static_cast<size_t>(i)];
    const auto gradient = gradient_in_surface(out.X(Eigen::all, about),
                                              out.apart(Eigen::all, about), out.X.col(i), T);
    if (!gradient) continue;
    const Tangents A = gradient_at(mesh, q, out.points[static_cast<size_t>(i)]) * T + *gradient;
    out.strain_seen[static_cast<size_t>(i)] = strain_of(A);
  }
}

}  // namespace

SeenSurface seen_surface(const Model& model, const Evaluation& evaluation,
                         const SeenOptions& options) {
  const Scene& scene = *model.scene;
  const Body& body = *scene.body;
  SeenSurface out;
  out.options = options, out.scene = model.scene;
  const BoundaryLocator locator(body.mesh);
  Renderer renderer(body.surface.mesh);
  std::map<std::string, SeenPoints> grids;  // by camera, as it stands in its first load case
  for (const ExampleEvaluation& example : evaluation.examples) {
    const auto e = static_cast<size_t>(example.example);
    const ExampleSpec& spec = scene.capture.examples[e];
    const VectorXd& q = example.equilibrium->q;
    SeenCase one;
    one.name = spec.name, one.use = spec.use(), one.rest = is_rest(spec);
    const std::vector<CasePhoto> photos = photos_of(model, example, renderer);
    for (const CasePhoto& photo : photos) {
      if (!grids.contains(photo.camera))
        grids.emplace(photo.camera,
                      grid_of(body, scene, photo.line.camera, renderer, locator, options));
      one.views.push_back(seen_by(grids.at(photo.camera), photo, photos, body.mesh, q));
      set_strain_seen(body.mesh, q, options.window, one.views.back());
    }
    for (const MeasuredEvaluation& measured : example.measured)
      if (const MeasuredSpec& told = spec.measured[static_cast<size_t>(measured.index)];
          told.field) {
        const TetMesh mesh = mesh_below(model, evaluation, told);
        one.views.push_back(seen_in_field(model, mesh, told, measured, q, options));
        set_strain_seen(mesh, q, options.window, one.views.back());
      }
    add_gauges(model, q, options, one);
    out.cases.push_back(std::move(one));
  }
  return out;
}

std::optional<double> noise_floor(const SeenSurface& seen, const std::string& view, bool strain) {
  double sum = 0.0, count = 0.0;
  for (const SeenCase& one : seen.cases)
    for (const SeenPoints& points : one.views) {
      if (!one.rest || points.view != view) continue;
      for (int i = 0; i < points.size(); ++i) {
        const auto& strain_seen = points.strain_seen[static_cast<size_t>(i)];
        const SurfaceStrain& own = points.strain[static_cast<size_t>(i)];
        if (strain && strain_seen) {
          sum += std::pow(strain_seen->xx - own.xx, 2) + std::pow(strain_seen->yy - own.yy, 2) +
                 std::pow(strain_seen->xy - own.xy, 2);
          count += 3.0;
        } else if (!strain && points.has_apart(i)) {
          sum += points.apart.col(i).squaredNorm();
          count += points.known[static_cast<size_t>(i)];
        }
      }
    }
  if (count == 0.0) return {};
  return std::sqrt(sum / count);
}

}  // namespace hookeye
