#define EIGEN_USE_BLAS  // OpenBLAS picks the processor's vectors at run time; Eigen is portable
                        // code
#include "render/condensed.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <unordered_map>

namespace hookeye {

using Eigen::MatrixXd;
using Eigen::MatrixXf;

namespace {

constexpr int kMaxBlock = 9;  ///< 3 numbers each of position, normal, reference
using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxBlock, kMaxBlock>;

/// Pixels whose segments lie on the same triangles share their vertices: one dense block.
struct Group {
  std::vector<int> triangles, vertices;
  std::vector<int> pixels;  ///< active pixel indices
};

std::vector<Group> group_pixels(const SurfaceMesh& surface, const ImageDerivative& dI) {
  std::vector<Group> groups;
  std::vector<int> single(surface.triangles.size(), -1);
  std::map<std::vector<int>, int> several;
  std::vector<int> key;
  for (size_t i = 0; i < dI.pixel.size(); ++i) {
    key.clear();
    for (int s = dI.first[i]; s < dI.first[i + 1]; ++s) key.push_back(dI.segments[s].triangle);
    if (key.empty()) continue;
    int* group = nullptr;
    if (key.size() == 1) {
      group = &single[key[0]];
    } else {
      std::sort(key.begin(), key.end());
      group = &several.try_emplace(key, -1).first->second;
    }
    if (*group < 0) {
      *group = static_cast<int>(groups.size());
      Group& g = groups.emplace_back();
      g.triangles = key;
      for (int t : key)
        g.vertices.insert(g.vertices.end(), surface.triangles[t].begin(),
                          surface.triangles[t].end());
      std::sort(g.vertices.begin(), g.vertices.end());
      g.vertices.erase(std::unique(g.vertices.begin(), g.vertices.end()), g.vertices.end());
    }
    groups[*group].pixels.push_back(static_cast<int>(i));
  }
  return groups;
}

}  // namespace

/// Symmetric M by blocks: vertex with vertex (upper half), vertex with photo columns, photo alone.
struct NodeNormalEquations::Impl {
  int vertices = 0, fields = 1;
  bool has_normals = false, has_reference = false;
  int block() const { return 3 * fields; }
  std::vector<int> seen;  ///< vertices that any pixel depends on
  std::vector<int> slot;  ///< vertex -> position in `seen`, -1
  struct Neighbour {
    int slot;
    size_t at;  ///< of its block in `values`
  };
  std::vector<std::vector<Neighbour>> row;  ///< slot -> blocks with slot' >= slot
  std::vector<double> values;               ///< blocks, column-major
  MatrixXd with_photo;                      ///< block()*seen x kPhotoColumns
  Eigen::Matrix<double, kPhotoColumns, kPhotoColumns> photo =
      Eigen::Matrix<double, kPhotoColumns, kPhotoColumns>::Zero();
  VectorXd b;  ///< block()*seen
  Eigen::Matrix<double, kPhotoColumns, 1> b_photo = Eigen::Matrix<double, kPhotoColumns, 1>::Zero();
  double r2 = 0;
  size_t count = 0;

  double* block_at(int i, int j);
  void find_seen(const std::vector<Group>& groups);
  void add_group(const SurfaceMesh& surface, const ImageDerivative& dI, const Group& group,
                 const VectorXd& w, const VectorXd& Bt_r);
};

double* NodeNormalEquations::Impl::block_at(int i, int j) {
  for (const Neighbour& n : row[i])
    if (n.slot == j) return values.data() + n.at;
  row[i].push_back({j, values.size()});
  values.resize(values.size() + block() * block(), 0.0);
  return values.data() + row[i].back().at;
}

void NodeNormalEquations::Impl::find_seen(const std::vector<Group>& groups) {
  slot.assign(vertices, -1);
  for (const Group& g : groups)
    for (int v : g.vertices) slot[v] = 0;
  for (int v = 0; v < vertices; ++v)
    if (slot[v] == 0) slot[v] = static_cast<int>(seen.size()), seen.push_back(v);
  row.resize(seen.size());
  with_photo.setZero(block() * static_cast<Eigen::Index>(seen.size()), kPhotoColumns);
  b.setZero(with_photo.rows());
}

namespace {

/// Row of one pixel: derivatives by the group's vertices, then by the photo's numbers.
void fill_row(const SurfaceMesh& surface, const ImageDerivative& dI, const Group& g, int pixel,
              bool normals, bool reference, int block, float* row) {
  for (int s = dI.first[pixel]; s < dI.first[pixel + 1]; ++s) {
    const DerivativeSegment& segment = dI.segments[s];
    for (int k = 0; k < 3; ++k) {
      const int v = surface.triangles[segment.triangle][k];
      int local = 0;
      while (g.vertices[local] != v) ++local;
      float* to = row + local * block;
      for (int c = 0; c < 3; ++c) *to++ += segment.d_position(c, k);
      if (normals)
        for (int c = 0; c < 3; ++c) *to++ += segment.d_normal(c, k);
      if (reference)
        for (int c = 0; c < 3; ++c) *to++ += segment.d_reference(c, k);
    }
  }
  Eigen::Map<Eigen::VectorXf>(row + g.vertices.size() * block, kPhotoColumns) =
      dI.d_photo.col(pixel);
}

}  // namespace

void NodeNormalEquations::Impl::add_group(const SurfaceMesh& surface, const ImageDerivative& dI,
                                          const Group& g, const VectorXd& w, const VectorXd& Bt_r) {
  const int n = block(), nv = static_cast<int>(g.vertices.size()), size = nv * n + kPhotoColumns;
  MatrixXf rows = MatrixXf::Zero(size, static_cast<Eigen::Index>(g.pixels.size()));
  VectorXd gradient = VectorXd::Zero(size);
  for (size_t i = 0; i < g.pixels.size(); ++i) {
    const int pixel = g.pixels[i];
    auto column = rows.col(static_cast<Eigen::Index>(i));
    fill_row(surface, dI, g, pixel, has_normals, has_reference, n, column.data());
    gradient += Bt_r[pixel] * column.cast<double>();
    column *= static_cast<float>(w[pixel]);
  }
  MatrixXf M = MatrixXf::Zero(size, size);
  M.selfadjointView<Eigen::Upper>().rankUpdate(rows);
  for (int i = 0; i < nv; ++i) {
    const int si = slot[g.vertices[i]];
    for (int j = i; j < nv; ++j)  // vertices ascend, so slots do
      Eigen::Map<MatrixXd>(block_at(si, slot[g.vertices[j]]), n, n) +=
          M.block(i * n, j * n, n, n).cast<double>();
    with_photo.middleRows(si * n, n) += M.block(i * n, nv * n, n, kPhotoColumns).cast<double>();
    b.segment(si * n, n) += gradient.segment(i * n, n);
  }
  photo += M.bottomRightCorner(kPhotoColumns, kPhotoColumns).cast<double>();
  b_photo += gradient.tail(kPhotoColumns);
}

NodeNormalEquations NodeNormalEquations::accumulate(const SurfaceMesh& surface,
                                                    const ImageDerivative& dI, const VectorXd& r,
                                                    const VectorXd& w, const VectorXd& Bt_r,
                                                    bool normals, bool reference) {
  NodeNormalEquations out;
  Impl& m = *out.impl_;
  m.vertices = static_cast<int>(surface.X.cols());
  m.has_normals = normals, m.has_reference = reference;
  m.fields = 1 + normals + reference;
  m.r2 = r.squaredNorm();
  m.count = static_cast<size_t>((w.array() != 0).count());
  const std::vector<Group> groups = group_pixels(surface, dI);
  m.find_seen(groups);
  for (const Group& g : groups) m.add_group(surface, dI, g, w, Bt_r);
  // Diagonal blocks were filled in their upper halves alone.
  const int n = m.block();
  for (size_t i = 0; i < m.seen.size(); ++i) {
    Eigen::Map<MatrixXd> d(m.block_at(int(i), int(i)), n, n);
    d.triangularView<Eigen::StrictlyLower>() = d.transpose();
  }
  m.photo.triangularView<Eigen::StrictlyLower>() = m.photo.transpose();
  return out;
}

CondensedPhoto NodeNormalEquations::reduce(const VertexSensitivity& S) const {
  const Impl& m = *impl_;
  const Eigen::Index params = S.position.cols(), n = m.block();
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  RowMajor Z(n * static_cast<Eigen::Index>(m.seen.size()), params);
  for (size_t i = 0; i < m.seen.size(); ++i) {
    Eigen::Index at = n * static_cast<Eigen::Index>(i);
    const Eigen::Index v = 3 * m.seen[i];
    Z.middleRows(at, 3) = S.position.middleRows(v, 3);
    if (m.has_normals) Z.middleRows(at += 3, 3) = S.normal.middleRows(v, 3);
    if (m.has_reference) Z.middleRows(at += 3, 3) = S.reference.middleRows(v, 3);
  }
  // J^T J = Z^T M Z with M = U + U^T - D: Y = (U - D/2) Z, then Z^T Y + Y^T Z.
  RowMajor Y = RowMajor::Zero(Z.rows(), params);
  for (size_t i = 0; i < m.seen.size(); ++i) {
    auto y = Y.middleRows(n * static_cast<Eigen::Index>(i), n);
    for (const Impl::Neighbour& j : m.row[i]) {
      const Eigen::Map<const MatrixXd> block(m.values.data() + j.at, n, n);
      const double half = j.slot == int(i) ? 0.5 : 1.0;
      y.noalias() += (half * block).eval().lazyProduct(Z.middleRows(n * j.slot, n));
    }
  }
  Y.noalias() += m.with_photo * S.photo;
  const MatrixXd ZtY = Z.transpose() * Y;
  CondensedPhoto out;
  out.JtJ = ZtY + ZtY.transpose() + S.photo.transpose() * m.photo * S.photo;
  out.Jtr = Z.transpose() * m.b + S.photo.transpose() * m.b_photo;
  out.r2 = m.r2;
  out.count = m.count;
  return out;
}

NodeNormalEquations::NodeNormalEquations() : impl_(std::make_unique<Impl>()) {}
NodeNormalEquations::~NodeNormalEquations() = default;
NodeNormalEquations::NodeNormalEquations(NodeNormalEquations&&) noexcept = default;
NodeNormalEquations& NodeNormalEquations::operator=(NodeNormalEquations&&) noexcept = default;

}  // namespace hookeye
