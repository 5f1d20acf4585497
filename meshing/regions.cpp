// Patches of the rest surface on a mesh: which nodes, which faces, which share of the area.
#include "meshing/regions.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <set>

#include "meshing/boundary_face.h"
#include "meshing/detail.h"
#include "meshing/triangle_tree.h"

namespace hookeye {
namespace {

using detail::cut_rule;
using detail::kCuts;
using detail::Sample;
using detail::whole_rule;
using Face = detail::BoundaryFace;

/// What decides whether a face or a point belongs to the patch.
struct Patch {
  enum class Share { none, whole, cut };
  std::function<Share(int)> share;                          ///< of a boundary face
  std::function<bool(const Vector3d&)> has;                 ///< of a point of a cut face
  std::function<bool(int node, const Vector3d&)> has_node;  ///< closed
};

class Collector {
 public:
  Collector(const TetMesh& mesh, Region& region) : mesh_(mesh), region_(region) {
    region_.nodal_area = VectorXd::Zero(mesh.nodes());
  }

  void add_face(int index, const Patch& patch) {
    const Patch::Share share = patch.share(index);
    if (share == Patch::Share::none) return;
    const Face face(mesh_, index);
    if (share == Patch::Share::whole) {
      for (const Sample& s : whole_rule()) add(face, s);
      region_.faces.emplace_back(index, 1.0);
      return;
    }
    int in = 0;
    for (const Sample& s : cut_rule()) {
      if (!patch.has(face.at(s.L))) continue;
      add(face, s);
      ++in;
    }
    if (in > 0) region_.faces.emplace_back(index, static_cast<double>(in) / (kCuts * kCuts));
  }

  void finish() {
    region_.area = area_;
    if (area_ > 0) region_.centroid = moment_ / area_;
    if (normal_.norm() > 1e-9 * area_) region_.normal = normal_.normalized();
  }

 private:
  void add(const Face& face, const Sample& s) {
    const Vector3d vector = s.weight * face.area_vector(s.L);
    const double area = vector.norm();
    const VectorXd N = face.shape(s.L);
    for (Eigen::Index k = 0; k < N.size(); ++k) region_.nodal_area[face.nodes()[k]] += area * N[k];
    area_ += area;
    normal_ += vector;
    moment_ += area * face.at(s.L);
  }

  const TetMesh& mesh_;
  Region& region_;
  double area_ = 0.0;
  Vector3d normal_ = Vector3d::Zero(), moment_ = Vector3d::Zero();
};

/// Box, sphere, halfspace: closed, with a tolerance of 1e-9 of the body's diagonal.
std::function<bool(const Vector3d&)> geometric(const RegionSpec& spec, double tolerance) {
  if (const auto* box = std::get_if<RegionSpec::Box>(&spec.shape)) {
    const Vector3d low = box->low.array() - tolerance, high = box->high.array() + tolerance;
    return [low, high](const Vector3d& x) {
      return (x.array() >= low.array()).all() && (x.array() <= high.array()).all();
    };
  }
  if (const auto* sphere = std::get_if<RegionSpec::Sphere>(&spec.shape)) {
    return [center = sphere->center, r = sphere->radius + tolerance](const Vector3d& x) {
      return (x - center).squaredNorm() <= r * r;
    };
  }
  const auto& half = std::get<RegionSpec::Halfspace>(spec.shape);
  return [point = half.point, normal = Vector3d(half.normal.normalized()),
          tolerance](const Vector3d& x) { return (x - point).dot(normal) >= -tolerance; };
}

/// Whether the shape may reach into the box: quick, never wrongly no.
std::function<bool(const Eigen::AlignedBox3d&)> may_reach(const RegionSpec& spec) {
  if (const auto* box = std::get_if<RegionSpec::Box>(&spec.shape)) {
    return [own = Eigen::AlignedBox3d(box->low, box->high)](const Eigen::AlignedBox3d& other) {
      return own.intersects(other);
    };
  }
  if (const auto* sphere = std::get_if<RegionSpec::Sphere>(&spec.shape)) {
    return [center = sphere->center, r = sphere->radius](const Eigen::AlignedBox3d& other) {
      return other.squaredExteriorDistance(center) <= r * r;
    };
  }
  const auto& half = std::get<RegionSpec::Halfspace>(spec.shape);
  return [point = half.point, normal = half.normal](const Eigen::AlignedBox3d& other) {
    const Vector3d farthest = (normal.array() > 0).select(other.max(), other.min());
    return (farthest - point).dot(normal) >= 0;
  };
}

/// One plane side of a shape.
struct Slab {
  Vector3d normal;
  double from;  ///< x.normal >= from
};

/// Directions along which the shape holds only a skin of the body, below a hundredth of its
/// diagonal. Such a shape means the faces that lie flat in the skin, not the thin strips of the
/// neighbouring sides that it also catches.
std::vector<Slab> skins(const RegionSpec& spec, const TetMesh& mesh, double tolerance) {
  std::vector<Slab> sides;
  if (const auto* box = std::get_if<RegionSpec::Box>(&spec.shape)) {
    for (int k = 0; k < 3; ++k) {
      sides.push_back({Vector3d::Unit(k), box->low[k]});
      sides.push_back({-Vector3d::Unit(k), -box->high[k]});
    }
  } else if (const auto* half = std::get_if<RegionSpec::Halfspace>(&spec.shape)) {
    const Vector3d normal = half->normal.normalized();
    sides.push_back({normal, half->point.dot(normal)});
  }
  std::vector<Slab> thin;
  for (Slab side : sides) {
    // Depth from this side of the shape to its far side or the body's, whichever comes first.
    double far = (mesh.X.transpose() * side.normal).maxCoeff();
    for (const Slab& other : sides) {
      if (other.normal == -side.normal) far = std::min(far, -other.from);
    }
    side.from -= tolerance;
    if (far - side.from < 0.01 * detail::diagonal(mesh.X)) thin.push_back(side);
  }
  return thin;
}

Patch geometric_patch(const RegionSpec& spec, const TetMesh& mesh) {
  const double tolerance = 1e-9 * detail::diagonal(mesh.X);
  const auto has = geometric(spec, tolerance);
  Patch patch;
  patch.has = has;
  patch.has_node = [has](int, const Vector3d& x) { return has(x); };
  // The shapes are convex: a straight face with all its corners inside is inside.
  patch.share = [has, reaches = may_reach(spec), thin = skins(spec, mesh, tolerance),
                 &mesh](int f) {
    const Face face(mesh, f);
    if (!reaches(face.box())) return Patch::Share::none;
    bool all = face.straight();
    for (int k = 0; k < 3; ++k) {
      const Vector3d x = mesh.X.col(mesh.boundary(k, f));
      all = all && has(x);
      for (const Slab& slab : thin) {
        if (x.dot(slab.normal) < slab.from) return Patch::Share::none;
      }
    }
    return all ? Patch::Share::whole : Patch::Share::cut;
  };
  return patch;
}

Patch group_patch(const RegionSpec& spec, const TetMesh& mesh) {
  const std::string& name = std::get<RegionSpec::Group>(spec.shape).name;
  const auto it = mesh.boundary_groups.find(name);
  if (it == mesh.boundary_groups.end()) {
    std::vector<std::string> known;
    for (const auto& entry : mesh.boundary_groups) known.push_back(entry.first);
    const std::string near = nearest_name(name, known);
    throw InputError(spec.place, fmt::format("the volume has no surface group '{}'", name),
                     known.empty()  ? "a volume with named surface groups (msh), or a box"
                     : near.empty() ? fmt::format("one of {}", fmt::join(known, ", "))
                                    : fmt::format("did you mean '{}'?", near));
  }
  const std::set<int> faces(it->second.begin(), it->second.end());
  std::set<int> nodes;
  for (const int f : faces) {
    for (Eigen::Index k = 0; k < mesh.boundary.rows(); ++k) nodes.insert(mesh.boundary(k, f));
  }
  Patch patch;
  patch.share = [faces](int f) {
    return faces.contains(f) ? Patch::Share::whole : Patch::Share::none;
  };
  patch.has_node = [nodes](int i, const Vector3d&) { return nodes.contains(i); };
  return patch;
}

/// Where the i-th triangle of a list stands.
Place place_of(const RegionSpec& spec, const RegionSpec::Faces& faces, size_t i) {
  if (i >= faces.told_at.size()) return spec.place;
  return {faces.told, faces.told_at[i][0], faces.told_at[i][1]};
}

/// Triangles of the file, as triangles of the mended surface.
std::set<int> chosen_triangles(const RegionSpec& spec, const MendedSurface* surface) {
  const auto& faces = std::get<RegionSpec::Faces>(spec.shape);
  if (surface == nullptr) {
    throw InputError(spec.place, "`faces` counts triangles of a surface file, but there is none",
                     "a `surface:` in body, or a box, sphere, halfspace or group");
  }
  std::map<int, int> mended_of;
  int triangles = 0;
  for (size_t t = 0; t < surface->file_triangle.size(); ++t) {
    mended_of[surface->file_triangle[t]] = static_cast<int>(t);
    triangles = std::max(triangles, surface->file_triangle[t] + 1);
  }
  std::set<int> chosen;
  for (size_t i = 0; i < faces.triangles.size(); ++i) {
    const int t = faces.triangles[i];
    if (t < 0 || t >= triangles) {
      throw InputError(
          place_of(spec, faces, i), fmt::format("there is no triangle {}", t),
          fmt::format("0 to {}: triangles of the surface file, counted from 0", triangles - 1));
    }
    const auto it = mended_of.find(t);
    if (it != mended_of.end()) chosen.insert(it->second);  // else dropped as a duplicate
  }
  return chosen;
}

/// For meshes that are not cut along the surface's triangles: a point belongs to its nearest one.
Patch nearest_patch(const std::set<int>& chosen, const SurfaceMesh& surface,
                    std::shared_ptr<const detail::TriangleTree> all, const TetMesh& mesh) {
  std::vector<std::array<int, 3>> own;
  Eigen::AlignedBox3d box;
  for (const int t : chosen) {
    own.push_back(surface.triangles[static_cast<size_t>(t)]);
    box.extend(all->box_of(t));
  }
  const auto patch_tree = std::make_shared<const detail::TriangleTree>(surface.X, own);
  // File coordinates are rounded: a node on the rim of the patch may lie a little outside it.
  const double tolerance = 1e-6 * detail::diagonal(surface.X);
  Patch patch;
  patch.has = [chosen, all](const Vector3d& x) {
    return chosen.contains(all->nearest(x).triangle);
  };
  patch.has_node = [=](int, const Vector3d& x) {
    return patch_tree->nearest(x).distance <= all->nearest(x).distance + tolerance;
  };
  patch.share = [=, &mesh, &surface](int f) {
    Eigen::AlignedBox3d reach;
    Vector3d center = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      reach.extend(Vector3d(mesh.X.col(mesh.boundary(k, f))));
      center += mesh.X.col(mesh.boundary(k, f)) / 3.0;
    }
    const double size = reach.diagonal().norm();
    reach.extend(reach.min() - Vector3d::Constant(size));
    reach.extend(reach.max() + Vector3d::Constant(size));
    if (!reach.intersects(box)) return Patch::Share::none;
    const detail::Hit hit = all->nearest(center);
    // A face inside one triangle of the surface needs no cutting.
    const auto& [a, b, c] = surface.triangles[static_cast<size_t>(hit.triangle)];
    bool within = true;
    for (int k = 0; k < 3 && within; ++k) {
      const Vector3d x = mesh.X.col(mesh.boundary(k, f));
      const Vector3d w =
          detail::closest_weights(x, surface.X.col(a), surface.X.col(b), surface.X.col(c));
      const Vector3d foot =
          w[0] * surface.X.col(a) + w[1] * surface.X.col(b) + w[2] * surface.X.col(c);
      within = (x - foot).norm() <= tolerance;
    }
    if (within) return chosen.contains(hit.triangle) ? Patch::Share::whole : Patch::Share::none;
    return Patch::Share::cut;
  };
  return patch;
}

/// For meshes that were filled from the surface. Faces that lie on several triangles are cut.
Patch parent_patch(std::set<int> chosen, const SurfaceMesh& surface,
                   std::shared_ptr<const detail::TriangleTree> all, const TetMesh& mesh) {
  const auto parent = [&mesh](int f) { return mesh.boundary_parent[static_cast<size_t>(f)]; };
  const Patch by_nearest = nearest_patch(chosen, surface, std::move(all), mesh);
  std::set<int> nodes, on_several;
  for (int f = 0; f < static_cast<int>(mesh.boundary.cols()); ++f) {
    if (parent(f) >= 0 && !chosen.contains(parent(f))) continue;
    for (Eigen::Index k = 0; k < mesh.boundary.rows(); ++k)
      (parent(f) < 0 ? on_several : nodes).insert(mesh.boundary(k, f));
  }
  Patch patch = by_nearest;
  patch.share = [=, chosen = std::move(chosen)](int f) {
    if (parent(f) < 0) return by_nearest.share(f);
    return chosen.contains(parent(f)) ? Patch::Share::whole : Patch::Share::none;
  };
  patch.has_node = [=](int i, const Vector3d& x) {
    return nodes.contains(i) || (on_several.contains(i) && by_nearest.has_node(i, x));
  };
  return patch;
}

/// Largest number of a shape [length]; 0: it has none.
double largest_number(const RegionSpec& spec) {
  if (const auto* box = std::get_if<RegionSpec::Box>(&spec.shape))
    return std::max(box->low.cwiseAbs().maxCoeff(), box->high.cwiseAbs().maxCoeff());
  if (const auto* sphere = std::get_if<RegionSpec::Sphere>(&spec.shape))
    return std::max(sphere->center.cwiseAbs().maxCoeff(), sphere->radius);
  if (const auto* half = std::get_if<RegionSpec::Halfspace>(&spec.shape))
    return half->point.cwiseAbs().maxCoeff();
  return 0.0;
}

/// Numbers some thousand times the body's, or a thousandth of them.
std::string other_unit(const RegionSpec& spec, const TetMesh& mesh) {
  constexpr double kLeast = 200.0, kMost = 5000.0;
  const double told = largest_number(spec), body = mesh.X.cwiseAbs().maxCoeff();
  const double ratio = body > 0.0 ? told / body : 0.0;
  if (ratio > kLeast && ratio < kMost)
    return fmt::format(
        "; the region's numbers are {:.3g} times the body's: is the body's file in m?", ratio);
  if (ratio > 1.0 / kMost && ratio < 1.0 / kLeast)
    return fmt::format("; the body's numbers are {:.3g} times the region's: is that in m?",
                       1.0 / ratio);
  return "";
}

[[noreturn]] void nothing_selected(const RegionSpec& spec, const TetMesh& mesh) {
  throw InputError(spec.place,
                   fmt::format("region '{}' selects no point of the surface", spec.name),
                   fmt::format("a patch of the body, which reaches from {} to {}{}",
                               detail::where(mesh.X.rowwise().minCoeff()),
                               detail::where(mesh.X.rowwise().maxCoeff()), other_unit(spec, mesh)));
}

Region build(const RegionSpec& spec, const TetMesh& mesh, const Patch& patch) {
  Region region;
  region.name = spec.name;
  Collector collector(mesh, region);
  for (int f = 0; f < static_cast<int>(mesh.boundary.cols()); ++f) collector.add_face(f, patch);
  collector.finish();
  std::vector<char> on_boundary(static_cast<size_t>(mesh.nodes()), 0);
  for (Eigen::Index i = 0; i < mesh.boundary.size(); ++i) {
    on_boundary[static_cast<size_t>(mesh.boundary.data()[i])] = 1;
  }
  for (int i = 0; i < mesh.nodes(); ++i) {
    if (on_boundary[static_cast<size_t>(i)] && patch.has_node(i, mesh.X.col(i))) {
      region.nodes.push_back(i);
    }
  }
  if (region.nodes.empty()) nothing_selected(spec, mesh);
  return region;
}

}  // namespace

RegionSet::RegionSet(const Capture& capture, const TetMesh& mesh, const MendedSurface* surface) {
  std::shared_ptr<const detail::TriangleTree> tree;
  for (const RegionSpec& spec : capture.regions) {
    Patch patch;
    if (std::holds_alternative<RegionSpec::Faces>(spec.shape)) {
      std::set<int> chosen = chosen_triangles(spec, surface);
      if (chosen.empty()) nothing_selected(spec, mesh);
      const SurfaceMesh& s = surface->surface;
      if (!tree) tree = std::make_shared<const detail::TriangleTree>(s.X, s.triangles);
      patch = mesh.boundary_parent.empty() ? nearest_patch(chosen, s, tree, mesh)
                                           : parent_patch(std::move(chosen), s, tree, mesh);
    } else if (std::holds_alternative<RegionSpec::Group>(spec.shape)) {
      patch = group_patch(spec, mesh);
    } else {
      patch = geometric_patch(spec, mesh);
    }
    regions_[spec.name] = build(spec, mesh, patch);
  }
}

const Region& RegionSet::at(const std::string& name) const { return regions_.at(name); }

}  // namespace hookeye
