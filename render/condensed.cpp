#define EIGEN_USE_BLAS  // OpenBLAS picks the processor's vectors at run time; Eigen is portable
                        // code
#include "render/condensed.h"

#include <algorithm>
#include <utility>

#include "render/vertex_sums.h"

namespace hookeye {

using Eigen::MatrixXd;

/// Symmetric M by blocks: vertex with vertex (upper half), vertex with photo columns, photo alone.
struct NodeNormalEquations::Impl {
  CondensedColumns columns;
  int numbers() const { return columns.second ? 6 : 3; }  ///< of a vertex
  std::vector<int> seen;                                  ///< vertices that any pixel depends on
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
  for (const ImageDerivative::Part& part : dI.parts)
    for (const DerivativeSegment& s : part.segments) touched[s.triangle] = 1;
  std::vector<int> slot(surface.X.cols(), -1);
  for (size_t t = 0; t < touched.size(); ++t)
    if (touched[t])
      for (int v : surface.triangles[t]) slot[v] = 0;
  for (size_t v = 0; v < slot.size(); ++v)
    if (slot[v] == 0) slot[v] = static_cast<int>(seen.size()), seen.push_back(static_cast<int>(v));
  row.resize(seen.size());
  sums.vertex.resize(seen.size());
  sums.block.reserve(4 * seen.size());
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

using Part = ImageDerivative::Part;

/// Gathers pixels that see the same triangles, as neighbours mostly do, and adds them together.
class RunOfPixels {
 public:
  RunOfPixels(const SurfaceMesh& surface, const std::vector<int>& slot,
              NodeNormalEquations::Impl* sums)
      : surface_(surface), slot_(slot), sums_(*sums), blocks_of_(surface.triangles.size()) {
    run_.numbers = sums->numbers();
    run_.with_photo = sums->columns.photo;
  }

  void add(const Part& part, size_t pixel, float w, float Bt_r) {
    if (w == 0 && Bt_r == 0) return flush();
    const int first = part.first[pixel], last = part.first[pixel + 1];
    const bool same = is(part, first, last);
    if (!same || run_.count == PixelRun::kPixels) flush();
    if (!same) set(part, first, last);
    if (run_.count == 0 && run_.with_photo) run_.photo = &part.photo[pixel];
    float* g = run_.vertices.data() + run_.at(run_.count, 0);
    if (triangles_.size() == 1)
      set_corners(part.segments[first], g);
    else
      add_corners(part.segments.data() + first, g);
    run_.ww[run_.count] = w * w;
    run_.Bt_r[run_.count++] = Bt_r;
  }

  void flush() {
    if (run_.count == 0) return;
    add_pixels(run_, &sums_.sums);
    constexpr int kShort = 512;  // pixels
    added_ += std::exchange(run_.count, 0);
    if (added_ < kShort) return;
    sums_.take_photo_sums();
    added_ = 0;
  }

 private:
  void set_corners(const DerivativeSegment& segment, float* g) const {
    for (int k = 0; k < 3; ++k) {
      float* to = g + local_[k] * kVertexFloats;  // maps: std::copy calls memmove for three floats
      Eigen::Map<Eigen::Vector3f>(to + 0) = segment.d_position.col(k);
      Eigen::Map<Eigen::Vector3f>(to + 3) = segment.d_second.col(k);
    }
  }
  void add_corners(const DerivativeSegment* segments, float* g) const {
    std::fill(g, g + kVertexFloats * run_.slots.size(), 0.0f);
    for (size_t s = 0; s < triangles_.size(); ++s)
      for (int k = 0; k < 3; ++k) {
        float* to = g + local_[3 * s + k] * kVertexFloats;
        for (int c = 0; c < 3; ++c) to[c] += segments[s].d_position(c, k);
        for (int c = 0; c < 3; ++c) to[3 + c] += segments[s].d_second(c, k);
      }
  }
  bool is(const Part& part, int first, int last) const {
    if (triangles_.size() != static_cast<size_t>(last - first)) return false;
    for (int s = first; s < last; ++s)
      if (triangles_[s - first] != part.segments[s].triangle) return false;
    return true;
  }
  void set(const Part& part, int first, int last) {
    std::vector<int>& slots = run_.slots;
    triangles_.clear(), slots.clear();
    for (int s = first; s < last; ++s) {
      triangles_.push_back(part.segments[s].triangle);
      for (int v : surface_.triangles[triangles_.back()]) slots.push_back(slot_[v]);
    }
    local_ = slots;
    std::sort(slots.begin(), slots.end());
    slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
    for (int& at : local_)
      at = static_cast<int>(std::lower_bound(slots.begin(), slots.end(), at) - slots.begin());
    if (triangles_.size() == 1) {
      auto& known = blocks_of_[triangles_[0]];
      if (known.empty()) known = blocks();
      run_.block = known;
    } else {
      run_.block = blocks();
    }
    const size_t size = run_.at(PixelRun::kPixels, 0);
    if (run_.vertices.size() < size) run_.vertices.resize(size);
  }

  std::vector<size_t> blocks() const {
    const std::vector<int>& slots = run_.slots;
    std::vector<size_t> out;
    for (size_t a = 0; a < slots.size(); ++a)
      for (size_t b = a; b < slots.size(); ++b) out.push_back(sums_.block_of(slots[a], slots[b]));
    return out;
  }

  const SurfaceMesh& surface_;
  const std::vector<int>& slot_;
  NodeNormalEquations::Impl& sums_;
  std::vector<std::vector<size_t>> blocks_of_;  ///< of pixels that see this triangle alone
  PixelRun run_;
  std::vector<int> triangles_;
  std::vector<int> local_;  ///< of corner k of segment s at 3s + k: position in slots
  int added_ = 0;           ///< pixels since the photo's sums were taken
};

}  // namespace

NodeNormalEquations NodeNormalEquations::accumulate(const SurfaceMesh& surface,
                                                    const ImageDerivative& dI, const VectorXd& r,
                                                    const VectorXd& w, const VectorXd& Bt_r,
                                                    CondensedColumns columns) {
  NodeNormalEquations out;
  Impl& m = *out.impl_;
  m.columns = columns;
  m.r2 = r.squaredNorm();
  m.count = static_cast<size_t>((w.array() != 0).count());
  m.photo.setZero(), m.b_photo.setZero();
  const std::vector<int> slot = m.number_vertices(surface, dI);
  RunOfPixels run(surface, slot, &m);
  Eigen::Index at = 0;
  for (const Part& part : dI.parts) {
    for (size_t i = 0; i < part.pixel.size(); ++i, ++at)
      run.add(part, i, static_cast<float>(w[at]), static_cast<float>(Bt_r[at]));
    run.flush();  // a run's pixels follow each other in one part
  }
  m.take_photo_sums();
  return out;
}

CondensedPhoto NodeNormalEquations::reduce(const VertexSensitivity& S) const {
  const Impl& m = *impl_;
  const Eigen::Index params = S.position.cols(), n = m.numbers();
  if (params == 0) return {MatrixXd(0, 0), VectorXd(0), m.r2, m.count};  // no product for BLAS
  const Eigen::Index rows = n * static_cast<Eigen::Index>(m.seen.size());
  RowMatrix Z(rows, params), with_photo(m.columns.photo ? rows : 0, kPhotoColumns);
  VectorXd b(rows);
  for (size_t i = 0; i < m.seen.size(); ++i) {
    const Eigen::Index at = n * static_cast<Eigen::Index>(i), v = 3 * m.seen[i];
    Z.middleRows(at, 3) = S.position.middleRows(v, 3);
    if (m.columns.second) Z.middleRows(at + 3, 3) = S.second.middleRows(v, 3);
    for (Eigen::Index c = 0; c < n; ++c) {
      b[at + c] = m.sums.vertex[i].b[c];
      for (int k = 0; k < kPhotoColumns && m.columns.photo; ++k)
        with_photo(at + c, k) = m.sums.vertex[i].photo[c][k];
    }
  }
  // J^T J = Z^T M Z with M = U + U^T - D: Y = (U - D/2) Z, then Z^T Y + Y^T Z.
  RowMatrix Y = RowMatrix::Zero(rows, params);
  for (size_t i = 0; i < m.seen.size(); ++i)
    for (const Impl::Neighbour& j : m.row[i])
      add_product(m.sums.block[j.block], j.slot == int(i) ? 0.5 : 1.0,
                  {static_cast<int>(n), static_cast<int>(params)}, Z.row(n * j.slot).data(),
                  Y.row(n * static_cast<Eigen::Index>(i)).data());
  if (m.columns.photo) Y.noalias() += with_photo * S.photo;
  const MatrixXd ZtY = Z.transpose() * Y;
  CondensedPhoto out;
  out.JtJ = ZtY + ZtY.transpose();
  out.Jtr = Z.transpose() * b;
  if (m.columns.photo) {
    const auto photo = m.photo.topLeftCorner<kPhotoColumns, kPhotoColumns>();
    out.JtJ += S.photo.transpose() * photo * S.photo;
    out.Jtr += S.photo.transpose() * m.b_photo.head<kPhotoColumns>();
  }
  out.r2 = m.r2;
  out.count = m.count;
  return out;
}

NodeNormalEquations::NodeNormalEquations() : impl_(std::make_unique<Impl>()) {}
NodeNormalEquations::~NodeNormalEquations() = default;
NodeNormalEquations::NodeNormalEquations(NodeNormalEquations&&) noexcept = default;
NodeNormalEquations& NodeNormalEquations::operator=(NodeNormalEquations&&) noexcept = default;

}  // namespace hookeye
