#define EIGEN_USE_BLAS  // OpenBLAS picks the processor's vectors at run time; Eigen is portable
                        // code
#include "render/condensed.h"

#include <algorithm>
#include <array>
#include <span>
#include <type_traits>
#include <utility>

#include "core/work_clock.h"
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
  Eigen::Matrix<double, kPhotoColumns, kPhotoColumns> photo;
  Eigen::Matrix<double, kPhotoColumns, 1> b_photo;
  bool uneven = false;  ///< any pixel has derivatives by uneven light
  size_t count = 0;
  int photo_columns() const { return !columns.photo ? 0 : uneven ? kPhotoColumns : kUneven; }

  int number(int vertex);
  size_t block_of(int i, int j);
  void take_photo_sums();
};

/// Position in `seen` of a vertex that was not there.
int NodeNormalEquations::Impl::number(int vertex) {
  seen.push_back(vertex);
  row.emplace_back().reserve(8);  // itself, and of some six neighbours those not before it
  sums.vertex.emplace_back();
  if (uneven) sums.uneven_vertex.emplace_back();
  return static_cast<int>(seen.size()) - 1;
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
  const auto block = [](const auto& of) {
    constexpr int kRows = std::extent_v<std::remove_reference_t<decltype(of)>, 0>;
    constexpr int kColumns = std::extent_v<std::remove_reference_t<decltype(of)>, 1>;
    using Floats = Eigen::Matrix<float, kRows, kColumns, Eigen::RowMajor>;
    return Eigen::Map<const Floats>(of[0]).template cast<double>().eval();
  };
  const auto row = [](const auto& of) {
    constexpr int kRows = std::extent_v<std::remove_reference_t<decltype(of)>, 0>;
    return Eigen::Map<const Eigen::Matrix<float, kRows, 1>>(of).template cast<double>().eval();
  };
  photo.topLeftCorner<kUneven, kUneven>() +=
      block(sums.photo.photo).topLeftCorner<kUneven, kUneven>();
  b_photo.head<kUneven>() += row(sums.photo.b).head<kUneven>();
  sums.photo = {};
  if (!uneven) return;
  const Eigen::Matrix<double, kUnevenNumbers, kUneven> mixed =
      block(sums.uneven.photo).leftCols<kUneven>();
  photo.bottomLeftCorner<kUnevenNumbers, kUneven>() += mixed;
  photo.topRightCorner<kUneven, kUnevenNumbers>() += mixed.transpose();
  photo.bottomRightCorner<kUnevenNumbers, kUnevenNumbers>() += block(sums.uneven.uneven);
  b_photo.tail<kUnevenNumbers>() += row(sums.uneven.b);
  sums.uneven = {};
}

namespace {

using Part = ImageDerivative::Part;

/// Gathers pixels that see the same triangles, as neighbours mostly do, and adds them together.
class RunOfPixels {
 public:
  RunOfPixels(const SurfaceMesh& surface, NodeNormalEquations::Impl* sums)
      : surface_(surface),
        slot_(surface.X.cols(), -1),
        sums_(*sums),
        singles_(surface.triangles.size()) {
    run_.numbers = sums->numbers();
    run_.with_photo = sums->columns.photo;
  }

  void add(const Part& part, size_t pixel, float w, float Bt_r) {
    if (w == 0 && Bt_r == 0) return flush();
    const DerivativeSegment* segments = part.segments.data() + part.first[pixel];
    const int count = part.first[pixel + 1] - part.first[pixel];
    const bool same = is(segments, count);
    if (!same || run_.count == PixelRun::kPixels) flush();
    if (!same) set(segments, count);
    if (run_.count == 0 && run_.with_photo) {
      run_.photo = &part.photo[pixel];
      run_.uneven = part.uneven.empty() ? nullptr : &part.uneven[pixel];
    }
    if (count != 1)
      add_corners(segments, sum_.data() + run_.count * run_.step);
    else if (run_.count == 0)
      run_.vertices = segments->d.data();  // the next pixel's segment is the next
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
  void add_corners(const DerivativeSegment* segments, float* g) const {
    std::fill(g, g + run_.step, 0.0f);
    for (size_t s = 0; s < triangles_.size(); ++s)
      for (int k = 0; k < 3; ++k) {
        float* to = g + local_[3 * s + k] * kVertexFloats;
        for (int c = 0; c < 6; ++c) to[c] += segments[s].d(c, k);
      }
  }
  bool is(const DerivativeSegment* segments, int count) const {
    if (triangles_.size() != static_cast<size_t>(count)) return false;
    for (int s = 0; s < count; ++s)
      if (triangles_[s] != segments[s].triangle) return false;
    return true;
  }
  void set(const DerivativeSegment* segments, int count) {
    triangles_.clear();
    for (int s = 0; s < count; ++s) triangles_.push_back(segments[s].triangle);
    if (count == 1)
      set_triangle(triangles_[0]);
    else
      set_triangles();
  }

  void set_triangle(int triangle) {
    Single& one = singles_[triangle];
    if (one.slots[0] < 0) {
      const std::array<int, 3> slots = slots_of(triangle);
      one.slots = slots;
      std::sort(one.slots.begin(), one.slots.end());
      for (int k = 0; k < 3; ++k) one.of_slot[place(one.slots, slots[k])] = 6 * k;
      add_blocks(one.slots, one.block.data());
    }
    run_.slots = one.slots, run_.of_slot = one.of_slot, run_.block = one.block;
    run_.step = sizeof(DerivativeSegment) / sizeof(float);
  }

  void set_triangles() {
    slots_.clear(), local_.clear(), of_slot_.clear();
    for (const int triangle : triangles_)
      for (const int slot : slots_of(triangle)) local_.push_back(slot);
    slots_ = local_;
    std::sort(slots_.begin(), slots_.end());
    slots_.erase(std::unique(slots_.begin(), slots_.end()), slots_.end());
    for (int& at : local_) at = static_cast<int>(place(slots_, at));
    for (size_t i = 0; i < slots_.size(); ++i) of_slot_.push_back(i * kVertexFloats);
    block_.resize(slots_.size() * (slots_.size() + 1) / 2);
    add_blocks(slots_, block_.data());
    run_.slots = slots_, run_.of_slot = of_slot_, run_.block = block_;
    run_.step = slots_.size() * kVertexFloats;
    if (sum_.size() < PixelRun::kPixels * run_.step) sum_.resize(PixelRun::kPixels * run_.step);
    run_.vertices = sum_.data();
  }

  std::array<int, 3> slots_of(int triangle) {
    std::array<int, 3> out;
    for (int k = 0; k < 3; ++k) {
      int& slot = slot_[surface_.triangles[triangle][k]];
      if (slot < 0) slot = sums_.number(surface_.triangles[triangle][k]);
      out[k] = slot;
    }
    return out;
  }
  static size_t place(std::span<const int> sorted, int slot) {
    return std::lower_bound(sorted.begin(), sorted.end(), slot) - sorted.begin();
  }
  void add_blocks(std::span<const int> slots, size_t* block) {
    for (size_t a = 0; a < slots.size(); ++a)
      for (size_t b = a; b < slots.size(); ++b) *block++ = sums_.block_of(slots[a], slots[b]);
  }

  /// What a run of pixels that see one triangle alone says of it; found once.
  struct Single {
    std::array<int, 3> slots = {-1, -1, -1};
    std::array<size_t, 3> of_slot;
    std::array<size_t, 6> block;
  };
  const SurfaceMesh& surface_;
  std::vector<int> slot_;  ///< vertex -> position in `seen`
  NodeNormalEquations::Impl& sums_;
  std::vector<Single> singles_;  ///< by triangle
  PixelRun run_;
  std::vector<int> triangles_;  ///< of run_
  // of pixels with several segments
  std::vector<float> sum_;
  std::vector<int> slots_, local_;  ///< corner k of segment s has slot slots_[local_[3 s + k]]
  std::vector<size_t> of_slot_, block_;
  int added_ = 0;  ///< pixels since the photo's sums were taken
};

}  // namespace

NodeNormalEquations NodeNormalEquations::accumulate(const SurfaceMesh& surface,
                                                    const ImageDerivative& dI, const VectorXd& wr,
                                                    const VectorXd& w, const VectorXd& Bt_r,
                                                    CondensedColumns columns, SumsBehind behind) {
  const Working part_of_work(WorkPart::sums);
  NodeNormalEquations out;
  Impl& m = *out.impl_;
  m.columns = columns;
  m.count = static_cast<size_t>((w.array() != 0).count());
  m.photo.setZero(), m.b_photo.setZero();
  for (const Part& part : dI.parts) m.uneven |= columns.photo && !part.uneven.empty();
  RunOfPixels run(surface, &m);
  Eigen::Index at = 0;
  double by_blur = 0;  // that column is of the blurred picture already
  for (const Part& part : dI.parts) {
    for (size_t i = 0; i < part.pixel.size(); ++i, ++at) {
      run.add(part, i, static_cast<float>(w[at]), static_cast<float>(Bt_r[at]));
      if (columns.photo) by_blur += double(part.photo[i][kBlur]) * wr[at];
    }
    run.flush();  // a run's pixels follow each other in one part
  }
  m.take_photo_sums();
  m.b_photo[kBlur] = by_blur;
  m.b_photo[kBackground] += behind.Bt_r;
  m.photo(kBackground, kBackground) += behind.ww;
  return out;
}

namespace {

/// Parameters that move a seen vertex: those of cameras, of light and of other examples move none.
std::vector<int> moving_columns(const VertexSensitivity& S, const NodeNormalEquations::Impl& m) {
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(S.position.cols());
  const auto look = [&](const RowMatrix& of, int vertex) {
    for (int i = 0; i < 3; ++i) sum += of.row(3 * vertex + i).cwiseAbs();
  };
  for (const int vertex : m.seen) {
    look(S.position, vertex);
    if (m.columns.second) look(S.second, vertex);
  }
  std::vector<int> moving;
  for (int j = 0; j < sum.size(); ++j)
    if (sum[j] != 0.0) moving.push_back(j);
  return moving;
}

}  // namespace

CondensedPhoto NodeNormalEquations::reduce(const VertexSensitivity& S) const {
  const Impl& m = *impl_;
  const Eigen::Index params = S.position.cols(), n = m.numbers();
  CondensedPhoto out{MatrixXd::Zero(params, params), VectorXd::Zero(params), 0.0, m.count};
  const std::vector<int> moving = moving_columns(S, m);
  const auto columns = static_cast<Eigen::Index>(moving.size());
  const Eigen::Index rows = n * static_cast<Eigen::Index>(m.seen.size());
  const Eigen::Index of_photo = m.photo_columns();
  RowMatrix Z(rows, columns), with_photo(of_photo > 0 ? rows : 0, of_photo);
  VectorXd b(rows);
  for (size_t i = 0; i < m.seen.size(); ++i) {
    const Eigen::Index at = n * static_cast<Eigen::Index>(i), v = 3 * m.seen[i];
    Z.middleRows(at, 3) = S.position.middleRows(v, 3)(Eigen::all, moving);
    if (m.columns.second) Z.middleRows(at + 3, 3) = S.second.middleRows(v, 3)(Eigen::all, moving);
    for (Eigen::Index c = 0; c < n; ++c) {
      b[at + c] = m.sums.vertex[i].b[c];
      for (int k = 0; k < kUneven && m.columns.photo; ++k)
        with_photo(at + c, k) = m.sums.vertex[i].photo[c][k];
      for (int k = 0; k < kUnevenNumbers && m.uneven; ++k)
        with_photo(at + c, kUneven + k) = m.sums.uneven_vertex[i].uneven[c][k];
    }
  }
  if (columns > 0) {  // no empty product for BLAS
    // J^T J = Z^T M Z with M = U + U^T - D: Y = (U - D/2) Z, then Z^T Y + Y^T Z.
    RowMatrix Y = RowMatrix::Zero(rows, columns);
    for (size_t i = 0; i < m.seen.size(); ++i)
      for (const Impl::Neighbour& j : m.row[i])
        add_product(m.sums.block[j.block], j.slot == int(i) ? 0.5 : 1.0,
                    {static_cast<int>(n), static_cast<int>(columns)}, Z.row(n * j.slot).data(),
                    Y.row(n * static_cast<Eigen::Index>(i)).data());
    const MatrixXd ZtY = Z.transpose() * Y;
    out.JtJ(moving, moving) = ZtY + ZtY.transpose();
    out.Jtr(moving) = Z.transpose() * b;
  }
  if (!m.columns.photo) return out;
  const auto by_photo = S.photo.topRows(of_photo);
  if (columns > 0) {
    const MatrixXd ZtP = (Z.transpose() * with_photo) * by_photo;
    out.JtJ(moving, Eigen::all) += ZtP;
    out.JtJ(Eigen::all, moving) += ZtP.transpose();
  }
  out.JtJ += by_photo.transpose() * m.photo.topLeftCorner(of_photo, of_photo) * by_photo;
  out.Jtr += by_photo.transpose() * m.b_photo.head(of_photo);
  return out;
}

NodeNormalEquations::NodeNormalEquations() : impl_(std::make_unique<Impl>()) {}
NodeNormalEquations::~NodeNormalEquations() = default;
NodeNormalEquations::NodeNormalEquations(NodeNormalEquations&&) noexcept = default;
NodeNormalEquations& NodeNormalEquations::operator=(NodeNormalEquations&&) noexcept = default;

}  // namespace hookeye
