#define EIGEN_USE_BLAS  // OpenBLAS picks the processor's vectors at run time; Eigen is portable
                        // code
#include "render/condensed.h"

#include <algorithm>

#include "render/vertex_sums.h"

namespace hookeye {

using Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Symmetric M by blocks: vertex with vertex (upper half), vertex with photo columns, photo alone.
struct NodeNormalEquations::Impl {
  bool second = false;
  int numbers() const { return second ? 6 : 3; }  ///< of a vertex
  std::vector<int> seen;                          ///< vertices that any pixel depends on
  struct Neighbour {
    int slot;
    size_t block;  ///< of `sums.block`
  };
  std::vector<std::vector<Neighbour>> row;  ///< position in `seen` -> those not before it
  VertexSums sums;
  Eigen::Matrix<double, kPhotoFloats, kPhotoFloats> photo;
  Eigen::Matrix<double, kPhotoFloats, 1> b_photo;
  double r2 = 0;
  size_t count = 0;

  std::vector<int> number_vertices(const SurfaceMesh& surface, const ImageDerivative& dI);
  size_t block_of(int i, int j);
  void take_photo_sums();
};

/// Numbers the vertices of all segments. Returns: vertex -> position in `seen`.
std::vector<int> NodeNormalEquations::Impl::number_vertices(const SurfaceMesh& surface,
                                                            const ImageDerivative& dI) {
  std::vector<char> touched(surface.triangles.size(), 0);
  for (const DerivativeSegment& s : dI.segments) touched[s.triangle] = 1;
  std::vector<int> slot(surface.X.cols(), -1);
  for (size_t t = 0; t < touched.size(); ++t)
    if (touched[t])
      for (int v : surface.triangles[t]) slot[v] = 0;
  for (size_t v = 0; v < slot.size(); ++v)
    if (slot[v] == 0) slot[v] = static_cast<int>(seen.size()), seen.push_back(static_cast<int>(v));
  row.resize(seen.size());
  sums.vertex.resize(seen.size());
  return slot;
}

size_t NodeNormalEquations::Impl::block_of(int i, int j) {
  for (const Neighbour& n : row[i])
    if (n.slot == j) return n.block;
  row[i].push_back({j, sums.block.size()});
  sums.block.emplace_back();
  return row[i].back().block;
}

/// What all pixels add to is kept short as floats.
void NodeNormalEquations::Impl::take_photo_sums() {
  using Floats = Eigen::Matrix<float, kPhotoFloats, kPhotoFloats, Eigen::RowMajor>;
  photo += Eigen::Map<const Floats>(sums.photo.photo[0]).cast<double>();
  b_photo += Eigen::Map<const Eigen::Matrix<float, kPhotoFloats, 1>>(sums.photo.b).cast<double>();
  sums.photo = {};
}

namespace {

/// The vertices of one pixel's triangles; neighbouring pixels often have the same.
struct Footprint {
  std::vector<int> triangles;
  std::vector<int> slots;     ///< ascending
  std::vector<int> local;     ///< of corner k of segment s at 3s + k: position in `slots`
  std::vector<size_t> block;  ///< of slots (i, j), i <= j, row by row

  bool is(const ImageDerivative& dI, int first, int last) const {
    if (triangles.size() != static_cast<size_t>(last - first)) return false;
    for (int s = first; s < last; ++s)
      if (triangles[s - first] != dI.segments[s].triangle) return false;
    return true;
  }
  void set(const SurfaceMesh& surface, const ImageDerivative& dI, const std::vector<int>& slot,
           int first, int last) {
    triangles.clear(), slots.clear(), local.clear(), block.clear();
    for (int s = first; s < last; ++s) {
      triangles.push_back(dI.segments[s].triangle);
      for (int v : surface.triangles[triangles.back()]) slots.push_back(slot[v]);
    }
    local = slots;
    std::sort(slots.begin(), slots.end());
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
    for (int& at : local)
      at = static_cast<int>(std::lower_bound(slots.begin(), slots.end(), at) - slots.begin());
  }
};

/// Derivatives of one pixel by the footprint's vertices, kVertexFloats each.
void fill_row(const ImageDerivative& dI, const Footprint& at, int first, bool second,
              std::vector<float>* row) {
  row->assign(at.slots.size() * kVertexFloats, 0.0f);
  for (size_t s = 0; s < at.triangles.size(); ++s) {
    const DerivativeSegment& segment = dI.segments[first + s];
    for (int k = 0; k < 3; ++k) {
      float* to = row->data() + at.local[3 * s + k] * kVertexFloats;
      for (int c = 0; c < 3; ++c) to[c] += segment.d_position(c, k);
      if (second)
        for (int c = 0; c < 3; ++c) to[3 + c] += segment.d_second(c, k);
    }
  }
}

}  // namespace

NodeNormalEquations NodeNormalEquations::accumulate(const SurfaceMesh& surface,
                                                    const ImageDerivative& dI, const VectorXd& r,
                                                    const VectorXd& w, const VectorXd& Bt_r,
                                                    bool second) {
  NodeNormalEquations out;
  Impl& m = *out.impl_;
  m.second = second;
  m.r2 = r.squaredNorm();
  m.count = static_cast<size_t>((w.array() != 0).count());
  m.photo.setZero(), m.b_photo.setZero();
  const std::vector<int> slot = m.number_vertices(surface, dI);
  constexpr size_t kShort = 512;  ///< pixels
  Footprint at;
  std::vector<float> row;
  for (size_t i = 0; i < dI.pixel.size(); ++i) {
    const int first = dI.first[i], last = dI.first[i + 1];
    if (!at.is(dI, first, last)) {
      at.set(surface, dI, slot, first, last);
      for (size_t a = 0; a < at.slots.size(); ++a)
        for (size_t b = a; b < at.slots.size(); ++b)
          at.block.push_back(m.block_of(at.slots[a], at.slots[b]));
    }
    fill_row(dI, at, first, second, &row);
    const Eigen::Index pixel = static_cast<Eigen::Index>(i);
    add_pixel({row.data(), dI.d_photo.col(pixel).data(), at.slots, at.block, float(w[pixel]),
               float(Bt_r[pixel])},
              &m.sums);
    if (i % kShort == kShort - 1) m.take_photo_sums();
  }
  m.take_photo_sums();
  return out;
}

CondensedPhoto NodeNormalEquations::reduce(const VertexSensitivity& S) const {
  const Impl& m = *impl_;
  const Eigen::Index params = S.position.cols(), n = m.numbers();
  const Eigen::Index rows = n * static_cast<Eigen::Index>(m.seen.size());
  RowMajor Z(rows, params), with_photo(rows, kPhotoColumns);
  VectorXd b(rows);
  for (size_t i = 0; i < m.seen.size(); ++i) {
    const Eigen::Index at = n * static_cast<Eigen::Index>(i), v = 3 * m.seen[i];
    Z.middleRows(at, 3) = S.position.middleRows(v, 3);
    if (m.second) Z.middleRows(at + 3, 3) = S.second.middleRows(v, 3);
    for (Eigen::Index c = 0; c < n; ++c) {
      b[at + c] = m.sums.vertex[i].b[c];
      for (int k = 0; k < kPhotoColumns; ++k) with_photo(at + c, k) = m.sums.vertex[i].photo[c][k];
    }
  }
  // J^T J = Z^T M Z with M = U + U^T - D: Y = (U - D/2) Z, then Z^T Y + Y^T Z.
  RowMajor Y = RowMajor::Zero(rows, params);
  for (size_t i = 0; i < m.seen.size(); ++i)
    for (const Impl::Neighbour& j : m.row[i])
      add_product(m.sums.block[j.block], j.slot == int(i) ? 0.5 : 1.0,
                  {static_cast<int>(n), static_cast<int>(params)}, Z.row(n * j.slot).data(),
                  Y.row(n * static_cast<Eigen::Index>(i)).data());
  Y.noalias() += with_photo * S.photo;
  const MatrixXd ZtY = Z.transpose() * Y;
  CondensedPhoto out;
  const auto photo = m.photo.topLeftCorner<kPhotoColumns, kPhotoColumns>();
  out.JtJ = ZtY + ZtY.transpose() + S.photo.transpose() * photo * S.photo;
  out.Jtr = Z.transpose() * b + S.photo.transpose() * m.b_photo.head<kPhotoColumns>();
  out.r2 = m.r2;
  out.count = m.count;
  return out;
}

NodeNormalEquations::NodeNormalEquations() : impl_(std::make_unique<Impl>()) {}
NodeNormalEquations::~NodeNormalEquations() = default;
NodeNormalEquations::NodeNormalEquations(NodeNormalEquations&&) noexcept = default;
NodeNormalEquations& NodeNormalEquations::operator=(NodeNormalEquations&&) noexcept = default;

}  // namespace hookeye
