#include "estimation/evaluation/brightness_sums.h"

namespace hookeye {

/// Neighbouring pixels see one triangle and lie by the same nodes mostly: they are added together.
class BrightnessSums::Run {
 public:
  using Corners = std::array<Brightness::Corner, 4>;
  Run(const SurfaceMesh& surface, BrightnessSums* sums) : surface_(surface), sums_(*sums) {}
  ~Run() { flush(); }
  void add(const DerivativeSegment& segment, const Corners& at, float gain, float factor) {
    if (segment.triangle != triangle_ || at[0].node != at_[0].node || count_ == kShort) {
      flush();
      triangle_ = segment.triangle, at_ = at;
    }
    const Eigen::Map<const Numbers> d(segment.d.data());
    for (int k = 0; k < 4; ++k) {
      sum_.col(2 * k) += at[k].weight * gain * d;
      sum_.col(2 * k + 1) += at[k].weight * factor * d;
    }
    ++count_;
  }

 private:
  static constexpr int kShort = 512;  ///< pixels that floats are exact enough for
  using Numbers = Eigen::Matrix<float, 18, 1>;
  void flush() {
    if (count_ == 0) return;
    for (int k = 0; k < 4; ++k)
      for (int v = 0; v < 3; ++v)
        sums_.slot(at_[k].node, surface_.triangles[triangle_][v]).by_vertex +=
            sum_.block<6, 2>(6 * v, 2 * k).cast<double>();
    sum_.setZero();
    count_ = 0;
  }
  const SurfaceMesh& surface_;
  BrightnessSums& sums_;
  int triangle_ = -1, count_ = 0;
  Corners at_ = {};
  Eigen::Matrix<float, 18, 8> sum_ = Eigen::Matrix<float, 18, 8>::Zero();
};

BrightnessSums::BrightnessSums(const Brightness& brightness, const SurfaceMesh& surface,
                               const ImageDerivative& dI, const VectorXd& w,
                               CondensedColumns columns)
    : brightness_(brightness),
      columns_(columns),
      nodes_(brightness.nodes()),
      products_(brightness.nodes()) {
  Run run(surface, this);
  Eigen::Index row = 0;
  for (const ImageDerivative::Part& part : dI.parts)
    for (size_t i = 0; i < part.pixel.size(); ++i, ++row) {
      const auto pixel = static_cast<size_t>(part.pixel[i]);
      if (!brightness.follows(pixel)) continue;
      const auto at = brightness.corners(pixel);
      const double I = brightness.unfollowed().values[pixel], ww = w[row] * w[row];
      const double gain = brightness.gain(pixel), factor = I * ww * gain;
      products_.add(at, ww * I * I);
      for (int s = part.first[i]; s < part.first[i + 1]; ++s)
        run.add(part.segments[s], at, static_cast<float>(gain), static_cast<float>(factor));
      if (!columns.photo) continue;
      const Eigen::Matrix<double, kPhotoFloats, 2> both =
          part.photo[i].cast<double>() * Eigen::RowVector2d(gain, factor);
      for (const auto& c : at) nodes_[c.node].by_photo += c.weight * both;
    }
}

BrightnessSums::Slot& BrightnessSums::slot(int node, int vertex) {
  auto& slots = nodes_[node].slots;
  // pixels follow each other: the last ones asked for are asked for again
  for (auto it = slots.rbegin(); it != slots.rend(); ++it)
    if (it->vertex == vertex) return *it;
  return slots.emplace_back(Slot{vertex, Eigen::Matrix<double, 6, 2>::Zero()});
}

void BrightnessSums::add_to(CondensedPhoto* sums, const VertexSensitivity& S) const {
  const auto count = static_cast<Eigen::Index>(nodes_.size());
  const Eigen::Index columns = sums->JtJ.cols();
  if (count == 0) return;
  RowMatrix B = RowMatrix::Zero(count, columns), E = B;  // B: U^T G dI
  for (Eigen::Index n = 0; n < count; ++n) {
    const auto add = [&](double of_B, double of_E, const auto& row) {
      if (of_B != 0.0) B.row(n) += of_B * row;
      if (of_E != 0.0) E.row(n) += of_E * row;
    };
    for (const Slot& one : nodes_[n].slots)
      for (int c = 0; c < (columns_.second ? 6 : 3); ++c)
        add(one.by_vertex(c, 0), one.by_vertex(c, 1),
            (c < 3 ? S.position : S.second).row(3 * one.vertex + c % 3));
    if (columns_.photo)
      for (int c = 0; c < kUneven; ++c)  // a texture that is a photo has its light in it
        add(nodes_[n].by_photo(c, 0), nodes_[n].by_photo(c, 1), S.photo.row(c));
  }
  const RowMatrix C = brightness_.change(B);
  RowMatrix FC = RowMatrix::Zero(count, columns);
  products_.for_each([&](int n, int other, double sum) { FC.row(n) += sum * C.row(other); });
  const Eigen::MatrixXd change = C.transpose() * (0.5 * FC - E);
  sums->JtJ += change + change.transpose();
}

}  // namespace hookeye
