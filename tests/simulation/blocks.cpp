#include "simulation/blocks.h"

#include <Eigen/Dense>
#include <fstream>
#include <random>
#include <set>
#include <stdexcept>

namespace hookeye::test {
namespace {

constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}};
constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};  // outward

int mid_node(int a, int b) {
  for (int k = 0; k < 6; ++k)
    if ((kEdges[k][0] == a && kEdges[k][1] == b) || (kEdges[k][0] == b && kEdges[k][1] == a))
      return 4 + k;
  throw std::logic_error("not an edge");
}

/// Faces of one element only; independent of the product's find_boundary.
void boundary_of(TetMesh& mesh) {
  std::map<std::array<int, 3>, std::vector<std::pair<int, int>>> owners;
  for (int e = 0; e < mesh.size(); ++e)
    for (int f = 0; f < 4; ++f) {
      std::array<int, 3> key;
      for (int i = 0; i < 3; ++i) key[i] = mesh.elements(kFaces[f][i], e);
      std::sort(key.begin(), key.end());
      owners[key].emplace_back(e, f);
    }
  const int n = mesh.order == 1 ? 3 : 6;
  std::vector<int> flat;
  for (const auto& [key, who] : owners) {
    if (who.size() != 1) continue;
    const auto [e, f] = who[0];
    mesh.boundary_element.push_back(e);
    for (int i = 0; i < 3; ++i) flat.push_back(mesh.elements(kFaces[f][i], e));
    for (int i = 0; n == 6 && i < 3; ++i)
      flat.push_back(mesh.elements(mid_node(kFaces[f][i], kFaces[f][(i + 1) % 3]), e));
  }
  mesh.boundary = Eigen::Map<Eigen::MatrixXi>(flat.data(), n, static_cast<int>(flat.size()) / n);
}

void add_mid_nodes(TetMesh& mesh) {
  std::map<std::pair<int, int>, int> mids;
  std::vector<Eigen::Vector3d> X;
  for (int i = 0; i < mesh.nodes(); ++i) X.push_back(mesh.X.col(i));
  Eigen::MatrixXi elements(10, mesh.size());
  elements.topRows(4) = mesh.elements;
  for (int e = 0; e < mesh.size(); ++e)
    for (int k = 0; k < 6; ++k) {
      const int a = mesh.elements(kEdges[k][0], e), b = mesh.elements(kEdges[k][1], e);
      const auto [at, added] = mids.try_emplace({std::min(a, b), std::max(a, b)}, X.size());
      if (added) X.push_back(0.5 * (X[a] + X[b]));
      elements(4 + k, e) = at->second;
    }
  mesh.order = 2;
  mesh.elements = elements;
  mesh.X.resize(3, static_cast<Eigen::Index>(X.size()));
  for (size_t i = 0; i < X.size(); ++i) mesh.X.col(static_cast<Eigen::Index>(i)) = X[i];
}

}  // namespace

TetMesh block(int nx, int ny, int nz, Eigen::Vector3d size, int order, double shake) {
  TetMesh mesh;
  mesh.order = 1;
  mesh.X.resize(3, (nx + 1) * (ny + 1) * (nz + 1));
  const auto id = [&](int i, int j, int k) { return (i * (ny + 1) + j) * (nz + 1) + k; };
  const VectorXd r = noise(mesh.X.size(), 7);
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j)
      for (int k = 0; k <= nz; ++k) {
        const int a = id(i, j, k);
        Eigen::Vector3d x(double(i) / nx, double(j) / ny, double(k) / nz);
        if (i % nx && j % ny && k % nz)
          x += shake * r.segment<3>(3 * a).cwiseQuotient(Eigen::Vector3d(nx, ny, nz));
        mesh.X.col(a) = x.cwiseProduct(size);
      }
  // Kuhn's six tetrahedra of a cube: one per order in which the axes are walked.
  const int walks[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};
  mesh.elements.resize(4, 6 * nx * ny * nz);
  int e = 0;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k)
        for (int w = 0; w < 6; ++w, ++e) {
          int at[3] = {i, j, k};
          mesh.elements(0, e) = id(at[0], at[1], at[2]);
          for (int step = 0; step < 3; ++step) {
            ++at[walks[w][step]];
            mesh.elements(step + 1, e) = id(at[0], at[1], at[2]);
          }
          if (w >= 3) std::swap(mesh.elements(1, e), mesh.elements(2, e));
        }
  if (order == 2) add_mid_nodes(mesh);
  boundary_of(mesh);
  return mesh;
}

TetMesh read_reference_mesh(const std::filesystem::path& file) {
  std::ifstream in(file);
  int n = 0, m = 0, npe = 0;
  in >> n >> m >> npe;
  TetMesh mesh;
  mesh.order = npe == 4 ? 1 : 2;
  mesh.X.resize(3, n);
  mesh.elements.resize(npe, m);
  for (double& x : mesh.X.reshaped()) in >> x;
  for (int& a : mesh.elements.reshaped()) in >> a;
  if (!in) throw std::runtime_error("cannot read " + file.string());
  boundary_of(mesh);
  return mesh;
}

double distance_to_reference(const std::filesystem::path& csv, const TetMesh& mesh,
                             const VectorXd& q) {
  std::ifstream in(csv);
  std::string line;
  std::getline(in, line);
  double most = 0;
  int rows = 0;
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream cells(line);
    int node;
    Eigen::Vector3d X, u;
    cells >> node >> X[0] >> X[1] >> X[2] >> u[0] >> u[1] >> u[2];
    const int a = node - 1;
    if (!cells || a < 0 || a >= mesh.nodes() || (mesh.X.col(a) - X).norm() > 1e-6)
      throw std::runtime_error(csv.string() + " is of another mesh: " + line);
    most = std::max(most, (q.segment<3>(3 * a) - mesh.X.col(a) - u).cwiseAbs().maxCoeff());
    ++rows;
  }
  if (rows != mesh.nodes()) throw std::runtime_error(csv.string() + " misses nodes");
  return most;
}

Region region_where(const TetMesh& mesh,
                    const std::function<bool(const Eigen::Vector3d&)>& inside) {
  Region region;
  region.name = "test";
  region.nodal_area = VectorXd::Zero(mesh.nodes());
  std::set<int> nodes;
  for (int f = 0; f < mesh.boundary.cols(); ++f) {
    const Eigen::VectorXi face = mesh.boundary.col(f);
    if (!std::all_of(face.begin(), face.end(), [&](int a) { return inside(mesh.X.col(a)); }))
      continue;
    nodes.insert(face.begin(), face.end());
    const Eigen::Vector3d a = mesh.X.col(face[0]), b = mesh.X.col(face[1]), c = mesh.X.col(face[2]);
    const Eigen::Vector3d v = 0.5 * (b - a).cross(c - a);
    for (int i = 0; i < 3; ++i) region.nodal_area[face[face.size() - 3 + i]] += v.norm() / 3;
    region.area += v.norm();
    region.normal += v;
    region.centroid += v.norm() * (a + b + c) / 3;
    region.faces.emplace_back(f, 1.0);
  }
  region.nodes.assign(nodes.begin(), nodes.end());
  region.centroid /= region.area;
  if (region.normal.norm() > 1e-9 * region.area) region.normal.normalize();
  return region;
}

VectorXd noise(Eigen::Index n, unsigned seed) {
  std::mt19937 generator(seed);
  VectorXd v(n);
  for (double& x : v) x = 2.0 * generator() / 4294967295.0 - 1.0;
  return v;
}

}  // namespace hookeye::test
