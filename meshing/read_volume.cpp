// Tetrahedral meshes from files: the raw readers, then one set of checks for all.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <fstream>
#include <map>
#include <set>

#include "meshing/detail.h"
#include "meshing/tet_mesh.h"

namespace hookeye {
namespace {

using detail::RawVolume;

std::string first_word(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string word;
  in >> word;
  return word;
}

RawVolume read_raw(const std::filesystem::path& file, const Place& place) {
  if (!std::filesystem::is_regular_file(file)) {
    throw InputError(place, fmt::format("there is no file {}", file.string()),
                     "a tetrahedral mesh: msh, vtu, inp or mesh");
  }
  std::string kind = file.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(),
                 [](unsigned char c) { return tolower(c); });
  if (kind == ".vtu") return detail::read_vtu(file);
  if (kind == ".inp") return detail::read_inp(file);
  if (kind == ".mesh") {
    const bool medit = first_word(file).rfind("MeshVersionFormatted", 0) == 0;
    return medit ? detail::read_gmsh(file, place) : detail::read_text_mesh(file);
  }
  if (kind == ".msh") {
    // Anything else would be taken for a script of gmsh's own language, which may run commands.
    if (first_word(file) != "$MeshFormat") {
      throw InputError({file.string(), 1}, "does not start with $MeshFormat",
                       "a gmsh mesh, format 2.2 or 4.1");
    }
    return detail::read_gmsh(file, place);
  }
  throw InputError(place, fmt::format("volumes of kind '{}' are not read", kind),
                   "msh (2.2, 4.1), vtu, inp or mesh");
}

std::string name_of(const RawVolume& raw, Eigen::Index e) {
  return raw.element_names.empty() ? std::to_string(e + 1)
                                   : raw.element_names[static_cast<size_t>(e)];
}

void check_numbers(const RawVolume& raw, const Place& place) {
  if (raw.elements.cols() == 0) {
    throw InputError(place, "the file holds no tetrahedra", "tetrahedra with 4 or 10 nodes");
  }
  for (Eigen::Index i = 0; i < raw.X.cols(); ++i) {
    if (!raw.X.col(i).allFinite()) {
      throw InputError(place, fmt::format("node {} has no finite position", i + 1),
                       "finite coordinates");
    }
  }
  for (Eigen::Index e = 0; e < raw.elements.cols(); ++e) {
    std::set<int> distinct;
    for (Eigen::Index k = 0; k < raw.elements.rows(); ++k) {
      const int i = raw.elements(k, e);
      if (i < 0 || i >= raw.X.cols()) {
        throw InputError(place,
                         fmt::format("element {} names a node that is not there", name_of(raw, e)),
                         fmt::format("nodes among the {} of the file", raw.X.cols()));
      }
      distinct.insert(i);
    }
    if (static_cast<Eigen::Index>(distinct.size()) != raw.elements.rows()) {
      throw InputError(place, fmt::format("element {} names a node twice", name_of(raw, e)),
                       "distinct nodes");
    }
  }
}

/// Drops nodes no tetrahedron uses. Returns the new number of each node, -1: dropped.
std::vector<int> drop_unused(RawVolume& raw, const Place& place, std::vector<std::string>* said) {
  std::vector<int> fresh(static_cast<size_t>(raw.X.cols()), -1);
  for (Eigen::Index i = 0; i < raw.elements.size(); ++i) {
    fresh[static_cast<size_t>(raw.elements.data()[i])] = 0;
  }
  int n = 0, dropped = 0, first = -1;
  for (size_t i = 0; i < fresh.size(); ++i) {
    if (fresh[i] < 0) {
      if (dropped++ == 0) first = static_cast<int>(i);
      continue;
    }
    raw.X.col(n) = raw.X.col(static_cast<Eigen::Index>(i)).eval();
    fresh[i] = n++;
  }
  if (dropped + raw.lost == 0) return fresh;
  const std::string message =
      fmt::format("{} nodes belong to no tetrahedron{}", dropped + raw.lost,
                  first < 0 ? "" : fmt::format(", the first being {}", first + 1));
  if (said == nullptr) throw InputError(place, message, "a mesh without loose nodes");
  said->push_back(message + "; they were dropped and later nodes renumbered");
  raw.X.conservativeResize(3, n);
  for (Eigen::Index i = 0; i < raw.elements.size(); ++i) {
    int& node = raw.elements.data()[i];
    node = fresh[static_cast<size_t>(node)];
  }
  return fresh;
}

void check_orientation(const TetMesh& mesh, const RawVolume& raw, const Place& place) {
  std::vector<Eigen::Vector4d> points{Eigen::Vector4d::Constant(0.25)};
  if (mesh.order == 2) {
    points.clear();
    // The four Gauss points of degree 2, and the corners.
    const double a = 0.58541019662496852, b = 0.1381966011250105;
    for (int k = 0; k < 4; ++k) {
      Eigen::Vector4d L = Eigen::Vector4d::Constant(b);
      L[k] = a;
      points.push_back(L);
      points.push_back(Eigen::Vector4d::Unit(k));
    }
  }
  for (int e = 0; e < mesh.size(); ++e) {
    const Vector3d x0 = mesh.X.col(mesh.elements(0, e));
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = Vector3d(mesh.X.col(mesh.elements(k + 1, e))) - x0;
    const double corners = edges.determinant();
    // Of its own size: a small element beside large ones has a volume, too.
    const double tiny = 1e-12 * std::pow(edges.colwise().norm().maxCoeff(), 3);
    if (corners <= tiny) {
      throw InputError(place,
                       fmt::format("element {} at {} {}", name_of(raw, e), detail::where(x0),
                                   corners < -tiny ? "is inverted" : "has no volume"),
                       "nodes ordered so that det[x1-x0, x2-x0, x3-x0] > 0");
    }
    for (const Eigen::Vector4d& L : points) {
      if (detail::jacobian(mesh, e, L) <= 0) {
        throw InputError(place,
                         fmt::format("element {} at {} is curved so much that it folds",
                                     name_of(raw, e), detail::where(x0)),
                         "mid nodes nearer to the middle of their edges");
      }
    }
  }
}

/// No face may have three elements, and every boundary edge two boundary faces at least.
void check_faces(const TetMesh& mesh, const RawVolume& raw, const Place& place) {
  std::map<std::array<int, 3>, int> uses;
  for (int e = 0; e < mesh.size(); ++e) {
    for (const auto& side : detail::kFaces) {
      std::array<int, 3> c{mesh.elements(side[0], e), mesh.elements(side[1], e),
                           mesh.elements(side[2], e)};
      std::sort(c.begin(), c.end());
      if (++uses[c] > 2) {
        throw InputError(place,
                         fmt::format("element {} shares a face at {} with more than one other",
                                     name_of(raw, e), detail::where(mesh.X.col(c[0]))),
                         "at most two elements a face (is an element there twice?)");
      }
    }
  }
}

void take_groups(TetMesh& mesh, const RawVolume& raw, const std::vector<int>& fresh) {
  mesh.volume_groups = raw.volume_groups;
  std::map<std::array<int, 3>, int> column_of;
  for (int f = 0; f < static_cast<int>(mesh.boundary.cols()); ++f) {
    std::array<int, 3> c{mesh.boundary(0, f), mesh.boundary(1, f), mesh.boundary(2, f)};
    std::sort(c.begin(), c.end());
    column_of[c] = f;
  }
  for (const auto& [name, faces] : raw.face_groups) {
    std::set<int> columns;
    for (std::array<int, 3> c : faces) {
      for (int& i : c) i = fresh[static_cast<size_t>(i)];
      std::sort(c.begin(), c.end());
      const auto it = column_of.find(c);
      if (it != column_of.end()) columns.insert(it->second);
    }
    if (!columns.empty()) mesh.boundary_groups[name].assign(columns.begin(), columns.end());
  }
  for (const auto& [name, nodes] : raw.node_groups) {
    std::set<int> in;
    for (const int i : nodes) in.insert(fresh[static_cast<size_t>(i)]);
    std::vector<int> columns;
    for (int f = 0; f < static_cast<int>(mesh.boundary.cols()); ++f) {
      bool all = true;
      for (int k = 0; k < 3; ++k) all = all && in.contains(mesh.boundary(k, f));
      if (all) columns.push_back(f);
    }
    if (!columns.empty()) mesh.boundary_groups.try_emplace(name, columns);
  }
}

}  // namespace

TetMesh read_volume(const std::filesystem::path& file, const Place& place,
                    std::vector<std::string>* said) {
  const Place at = {file.string()};
  RawVolume raw = read_raw(file, place.file.empty() ? at : place);
  check_numbers(raw, at);
  const std::vector<int> fresh = drop_unused(raw, at, said);
  TetMesh mesh;
  mesh.order = raw.elements.rows() == 4 ? 1 : 2;
  mesh.X = raw.X;
  mesh.elements = raw.elements;
  check_orientation(mesh, raw, at);
  check_faces(mesh, raw, at);
  find_boundary(mesh);
  take_groups(mesh, raw, fresh);
  return mesh;
}

}  // namespace hookeye
