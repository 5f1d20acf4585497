#include "meshing/body.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/work_clock.h"
#include "meshing/detail.h"
#include "meshing/subdivide.h"
#include "meshing/triangle_tree.h"

namespace hookeye {
namespace {

/// Flat pieces of the boundary: the face itself, or its four parts between the mid nodes.
std::vector<std::array<int, 3>> boundary_pieces(const TetMesh& mesh, std::vector<int>* face_of) {
  std::vector<std::array<int, 3>> pieces;
  for (int f = 0; f < static_cast<int>(mesh.boundary.cols()); ++f) {
    const auto n = mesh.boundary.col(f);
    if (mesh.order == 1) {
      pieces.push_back({n[0], n[1], n[2]});
    } else {
      pieces.push_back({n[0], n[3], n[5]});
      pieces.push_back({n[3], n[1], n[4]});
      pieces.push_back({n[5], n[4], n[2]});
      pieces.push_back({n[3], n[4], n[5]});
    }
    face_of->resize(pieces.size(), f);
  }
  return pieces;
}

/// Weights of a piece's corners in its face.
const Eigen::Matrix3d& piece_corners(int order, int piece) {
  static const std::array<Eigen::Matrix3d, 5> corners = [] {
    std::array<Eigen::Matrix3d, 5> c;  // columns: weights in the face of the piece's corners
    c[0] << 1, .5, .5, 0, .5, 0, 0, 0, .5;
    c[1] << .5, 0, 0, .5, 1, .5, 0, 0, .5;
    c[2] << .5, 0, 0, 0, .5, 0, .5, .5, 1;
    c[3] << .5, 0, .5, .5, .5, 0, 0, .5, .5;
    c[4] = Eigen::Matrix3d::Identity();
    return c;
  }();
  return corners[static_cast<size_t>(order == 1 ? 4 : piece % 4)];
}

}  // namespace

struct BoundaryLocator::Impl {
  const TetMesh& mesh;
  std::vector<int> face_of;
  detail::TriangleTree tree;
  explicit Impl(const TetMesh& m) : mesh(m), tree(m.X, boundary_pieces(m, &face_of)) {}
};

BoundaryLocator::BoundaryLocator(const TetMesh& mesh) : impl_(std::make_unique<Impl>(mesh)) {}
BoundaryLocator::~BoundaryLocator() = default;

double BoundaryLocator::locate(const Vector3d& X, SurfacePoint* point) const {
  const TetMesh& mesh = impl_->mesh;
  const detail::Hit hit = impl_->tree.nearest(X);
  if (hit.triangle < 0) return INFINITY;
  const int face = impl_->face_of[static_cast<size_t>(hit.triangle)];
  const Vector3d weights = piece_corners(mesh.order, hit.triangle) * hit.weights;
  point->element = mesh.boundary_element[static_cast<size_t>(face)];
  point->barycentric.setZero();
  for (int k = 0; k < 3; ++k) {
    for (int c = 0; c < 4; ++c) {
      if (mesh.elements(c, point->element) == mesh.boundary(k, face)) {
        point->barycentric[c] = weights[k];
      }
    }
  }
  return hit.distance;
}

double locate_on_boundary(const TetMesh& mesh, const Vector3d& X, SurfacePoint* point) {
  return BoundaryLocator(mesh).locate(X, point);
}

Matrix3Xd RenderSurface::deformed(const TetMesh& tets, const VectorXd& q) const {
  const Eigen::Map<const Matrix3Xd> x(q.data(), 3, tets.nodes());
  const Matrix3Xd u = x - tets.X;
  return mesh.X + (W * u.transpose()).transpose();
}

namespace {

Eigen::SparseMatrix<double, Eigen::RowMajor> weights_of(const TetMesh& mesh,
                                                        const std::vector<SurfacePoint>& points) {
  std::vector<Eigen::Triplet<double>> entries;
  for (size_t v = 0; v < points.size(); ++v) {
    const VectorXd N = shape_functions(mesh.order, points[v].barycentric);
    for (Eigen::Index k = 0; k < N.size(); ++k) {
      if (std::abs(N[k]) < 1e-14) continue;
      entries.emplace_back(static_cast<int>(v), mesh.elements(k, points[v].element), N[k]);
    }
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> W(static_cast<Eigen::Index>(points.size()),
                                                 mesh.nodes());
  W.setFromTriplets(entries.begin(), entries.end());
  return W;
}

/// Largest distance of the vertices from the mesh's boundary; fills the points.
double place_on(const TetMesh& mesh, RenderSurface& surface) {
  const BoundaryLocator locator(mesh);
  surface.points.resize(static_cast<size_t>(surface.mesh.X.cols()));
  double farthest = 0.0;
  for (size_t v = 0; v < surface.points.size(); ++v) {
    farthest = std::max(farthest, locator.locate(surface.mesh.X.col(static_cast<Eigen::Index>(v)),
                                                 &surface.points[v]));
  }
  return farthest;
}

/// Whether the triangles are faces of the mesh: every vertex a corner node, every triangle a
/// boundary face. Vertices alone would not do: a mesh filled from a coarse surface has them all.
bool triangles_are_faces(const TetMesh& mesh, const RenderSurface& surface, double farthest,
                         double tolerance) {
  if (farthest > tolerance) return false;
  std::vector<int> node_of;
  for (const SurfacePoint& p : surface.points) {
    int corner = 0;
    if (p.barycentric.maxCoeff(&corner) < 1.0 - 1e-4) return false;
    node_of.push_back(mesh.elements(corner, p.element));
  }
  std::set<std::array<int, 3>> faces;
  for (Eigen::Index f = 0; f < mesh.boundary.cols(); ++f) {
    std::array<int, 3> c{mesh.boundary(0, f), mesh.boundary(1, f), mesh.boundary(2, f)};
    std::sort(c.begin(), c.end());
    faces.insert(c);
  }
  for (const auto& t : surface.mesh.triangles) {
    std::array<int, 3> c;
    for (size_t k = 0; k < 3; ++k) c[k] = node_of[static_cast<size_t>(t[k])];
    std::sort(c.begin(), c.end());
    if (!faces.contains(c)) return false;
  }
  return true;
}

RenderSurface own_boundary(const TetMesh& mesh) {
  RenderSurface out;
  std::vector<int> face_of, vertex_of(static_cast<size_t>(mesh.nodes()), -1), nodes;
  out.mesh.triangles = boundary_pieces(mesh, &face_of);
  for (auto& triangle : out.mesh.triangles) {
    for (int& i : triangle) {
      int& v = vertex_of[static_cast<size_t>(i)];
      if (v < 0) {
        v = static_cast<int>(nodes.size());
        nodes.push_back(i);
      }
      i = v;
    }
  }
  out.file_triangle.assign(out.mesh.triangles.size(), -1);
  out.mesh.X.resize(3, static_cast<Eigen::Index>(nodes.size()));
  for (size_t v = 0; v < nodes.size(); ++v) {
    out.mesh.X.col(static_cast<Eigen::Index>(v)) = mesh.X.col(nodes[v]);
  }
  place_on(mesh, out);
  out.W = weights_of(mesh, out.points);
  return out;
}

double mean_boundary_edge(const TetMesh& mesh) {
  double sum = 0.0;
  for (Eigen::Index f = 0; f < mesh.boundary.cols(); ++f) {
    for (int k = 0; k < 3; ++k) {
      sum += (mesh.X.col(mesh.boundary(k, f)) - mesh.X.col(mesh.boundary((k + 1) % 3, f))).norm();
    }
  }
  return sum / (3.0 * static_cast<double>(mesh.boundary.cols()));
}

/// Edges of a drawn part: a third of them or more lie within a plane face, as of a box of twelve
/// triangles, and some are sharp, by 60 degrees (a hexagonal bar) or more.
bool plane_faces_and_sharp_edges(const SurfaceMesh& surface) {
  constexpr double kPlane = 0.99996, kSharp = 0.5;  // cosines of 0.5 and 60 degrees
  std::map<std::pair<int, int>, Vector3d> normal_at;
  size_t plane = 0, sharp = 0;
  for (const auto& t : surface.triangles) {
    const Vector3d a = surface.X.col(t[0]), b = surface.X.col(t[1]), c = surface.X.col(t[2]);
    const Vector3d normal = (b - a).cross(c - a).stableNormalized();
    for (size_t k = 0; k < 3; ++k) {
      const auto [at, fresh] = normal_at.try_emplace(std::minmax(t[k], t[(k + 1) % 3]), normal);
      if (fresh) continue;
      const double cosine = at->second.dot(normal);
      plane += cosine > kPlane, sharp += cosine < kSharp + 1e-6;
    }
  }
  return sharp > 0 && 3 * plane >= normal_at.size();
}

RenderSurface ride(const TetMesh& mesh, const MendedSurface& file, std::vector<std::string>& said) {
  RenderSurface out;
  out.mesh = file.surface;
  out.file_triangle = file.file_triangle;
  const double size = detail::diagonal(mesh.X);
  const double farthest = place_on(mesh, out);
  if (triangles_are_faces(mesh, out, farthest, 1e-5 * size)) {
    for (SurfacePoint& p : out.points) {
      p.barycentric = p.barycentric.array().round();  // a selection: exactly one node a vertex
    }
    out.W = weights_of(mesh, out.points);
    return out;
  }
  const double edge = mean_boundary_edge(mesh);
  if (farthest > 0.1 * edge) {
    said.push_back(
        fmt::format("the surface lies up to {:.3g} away from the volume's boundary", farthest));
  }
  const detail::Subdivided fine =
      detail::subdivide(file.surface, mesh.order == 1 ? edge : 0.5 * edge);
  out.mesh = fine.mesh;
  out.file_triangle.clear();
  for (const int t : fine.parent) {
    out.file_triangle.push_back(file.file_triangle[static_cast<size_t>(t)]);
  }
  place_on(mesh, out);
  out.W = weights_of(mesh, out.points);
  return out;
}

SurfaceMesh surface_of(const BodySpec& spec) {
  try {
    return read_surface(spec.surface);
  } catch (const InputError& error) {
    throw told_at(spec.surface_place, error);
  }
}

TetMesh volume_of(const BodySpec& spec, std::vector<std::string>& said) {
  try {
    return read_volume(spec.volume, spec.volume_place, &said);
  } catch (const InputError& error) {
    throw told_at(spec.volume_place, error);
  }
}

TetMesh make_mesh(const BodySpec& spec, const MendedSurface* surface, double edge_factor, int order,
                  std::vector<std::string>& said) {
  if (!spec.volume.empty()) {
    const TetMesh mesh = volume_of(spec, said);
    if (edge_factor != 1.0 && surface == nullptr) {
      said.emplace_back("the volume of the file was kept: only a surface can be meshed anew");
    }
    if (edge_factor == 1.0 || surface == nullptr)
      return with_order(mesh, order ? order : mesh.order);
    FillOptions options;
    options.edge = edge_factor * quality(mesh).mean_edge;
    options.order = order ? order : mesh.order;
    return fill(surface->surface, options, spec.surface_place, &said);
  }
  if (surface == nullptr) {
    throw InputError(
        spec.place, "the body has neither a surface nor a volume",
        "`surface: FILE` (obj, ply, stl), `volume: FILE` (msh, vtu, inp, mesh) or both");
  }
  FillOptions options;
  options.edge = spec.edge > 0 ? spec.edge : detail::diagonal(surface->surface.X) / 12.0;
  options.order = order ? order : spec.order;
  if (!spec.mesh_given) {
    said.push_back(
        fmt::format("no `mesh:` given: edge {:.3g}, order {}", options.edge, options.order));
  }
  options.edge *= edge_factor;
  return fill(surface->surface, options, spec.surface_place, &said);
}

Body make(const Capture& capture, double edge_factor, int order, const RenderSurface* seen) {
  Body body;
  const BodySpec& spec = capture.body;
  std::unique_ptr<MendedSurface> surface;
  if (!spec.surface.empty()) {
    const Place place =
        spec.surface_place.file.empty() ? Place{spec.surface.string()} : spec.surface_place;
    surface = std::make_unique<MendedSurface>(mend(surface_of(spec), place));
    body.said = surface->said;
  }
  body.mesh = make_mesh(spec, surface.get(), edge_factor, order, body.said);
  if (seen) {
    body.surface = *seen;
    place_on(body.mesh, body.surface);
    body.surface.W = weights_of(body.mesh, body.surface.points);
  } else {
    body.surface = surface ? ride(body.mesh, *surface, body.said) : own_boundary(body.mesh);
    const bool lit =
        spec.texture == BodySpec::Texture::image || spec.texture == BodySpec::Texture::uniform;
    if (surface && lit && !spec.flat_shading && !body.surface.mesh.cut_from.empty() &&
        plane_faces_and_sharp_edges(surface->surface))
      body.said.emplace_back(
          "the surface has plane faces and sharp edges that are lit as if they were round: "
          "`shading: flat` lights them as they are");
  }
  body.regions = RegionSet(capture, body.mesh, surface.get());
  return body;
}

}  // namespace

Body make_body(const Capture& capture) {
  const Working part(WorkPart::meshing);
  return make(capture, 1.0, 0, nullptr);
}

Body remesh(const Capture& capture, const Body& told, double edge_factor, int order) {
  const Working part(WorkPart::meshing);
  return make(capture, edge_factor, order, &told.surface);
}

}  // namespace hookeye
