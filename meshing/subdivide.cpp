#include "meshing/subdivide.h"

#include <map>

namespace hookeye::detail {
namespace {

struct Corner {
  int vertex;
  Vector2d uv;
};
using Corners = std::array<Corner, 3>;

class Round {
 public:
  Round(const Subdivided& from, double longest) : from_(from), X_(from.mesh.X) {
    for (const auto& t : from.mesh.triangles) {
      for (int k = 0; k < 3; ++k) {
        const auto edge = std::minmax(t[k], t[(k + 1) % 3]);
        if (mid_of_.contains(edge)) continue;
        const Vector3d a = X_.col(edge.first), b = X_.col(edge.second);
        if ((a - b).norm() <= longest) continue;
        mid_of_[edge] = static_cast<int>(X_.cols() + static_cast<Eigen::Index>(mids_.size()));
        mids_.push_back(0.5 * (a + b));
        ends_.push_back(edge);
      }
    }
  }
  bool idle() const { return mids_.empty(); }

  /// For each new vertex the two between which it lies.
  const std::vector<std::pair<int, int>>& ends() const { return ends_; }

  Subdivided result() {
    for (size_t t = 0; t < from_.mesh.triangles.size(); ++t) {
      Corners c;
      for (size_t k = 0; k < 3; ++k) {
        c[k] = {from_.mesh.triangles[t][k],
                from_.mesh.uv.empty() ? Vector2d::Zero() : from_.mesh.uv[t][k]};
      }
      split(c, from_.parent[t]);
    }
    out_.mesh.X.resize(3, X_.cols() + static_cast<Eigen::Index>(mids_.size()));
    out_.mesh.X.leftCols(X_.cols()) = X_;
    for (size_t i = 0; i < mids_.size(); ++i) {
      out_.mesh.X.col(X_.cols() + static_cast<Eigen::Index>(i)) = mids_[i];
    }
    return std::move(out_);
  }

 private:
  int mid(const Corner& a, const Corner& b) const {
    const auto it = mid_of_.find(std::minmax(a.vertex, b.vertex));
    return it == mid_of_.end() ? -1 : it->second;
  }

  Vector3d at(const Corner& c) const {
    return c.vertex < X_.cols() ? Vector3d(X_.col(c.vertex)) : mids_[c.vertex - X_.cols()];
  }

  void emit(const Corner& a, const Corner& b, const Corner& c, int parent) {
    out_.mesh.triangles.push_back({a.vertex, b.vertex, c.vertex});
    if (!from_.mesh.uv.empty()) out_.mesh.uv.push_back({a.uv, b.uv, c.uv});
    out_.parent.push_back(parent);
  }

  void split(const Corners& corner, int parent) {
    std::array<Corner, 3> m;  // mid of edge k, k+1
    int count = 0, some = 0, kept = 0;
    for (int k = 0; k < 3; ++k) {
      const Corner &a = corner[k], &b = corner[(k + 1) % 3];
      m[k] = {mid(a, b), 0.5 * (a.uv + b.uv)};
      if (m[k].vertex >= 0) {
        ++count;
        some = k;
      } else {
        kept = k;
      }
    }
    if (count == 0) return emit(corner[0], corner[1], corner[2], parent);
    if (count == 3) {
      emit(corner[0], m[0], m[2], parent);
      emit(m[0], corner[1], m[1], parent);
      emit(m[2], m[1], corner[2], parent);
      return emit(m[0], m[1], m[2], parent);
    }
    if (count == 1) {
      const Corner &a = corner[some], &b = corner[(some + 1) % 3], &c = corner[(some + 2) % 3];
      emit(a, m[some], c, parent);
      return emit(m[some], b, c, parent);
    }
    // Edge ab stays: cut off the corner c, then the quadrilateral by its shorter diagonal.
    const Corner &a = corner[kept], &b = corner[(kept + 1) % 3], &c = corner[(kept + 2) % 3];
    const Corner &bc = m[(kept + 1) % 3], &ca = m[(kept + 2) % 3];
    emit(ca, bc, c, parent);
    if ((at(a) - at(bc)).squaredNorm() <= (at(b) - at(ca)).squaredNorm()) {
      emit(a, b, bc, parent);
      return emit(a, bc, ca, parent);
    }
    emit(a, b, ca, parent);
    emit(b, bc, ca, parent);
  }

  const Subdivided& from_;
  const Matrix3Xd& X_;
  std::map<std::pair<int, int>, int> mid_of_;
  std::vector<Vector3d> mids_;
  std::vector<std::pair<int, int>> ends_;
  Subdivided out_;
};

Eigen::SparseMatrix<double, Eigen::RowMajor> rows_of(
    const std::vector<std::map<int, double>>& weights, int columns) {
  std::vector<Eigen::Triplet<double>> entries;
  for (size_t v = 0; v < weights.size(); ++v)
    for (const auto& [of, w] : weights[v]) entries.emplace_back(static_cast<int>(v), of, w);
  Eigen::SparseMatrix<double, Eigen::RowMajor> out(static_cast<Eigen::Index>(weights.size()),
                                                   columns);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

}  // namespace

std::vector<std::pair<int, int>> bisect(Subdivided& now, double longest) {
  Round round(now, longest);
  if (round.idle()) return {};
  now = round.result();
  return round.ends();
}

Subdivided subdivide(const SurfaceMesh& surface, double longest) {
  Subdivided now;
  now.mesh = surface;
  const auto given = static_cast<int>(surface.X.cols());
  std::vector<std::map<int, double>> weights(static_cast<size_t>(given));
  for (int v = 0; v < given; ++v) weights[static_cast<size_t>(v)] = {{v, 1.0}};
  for (size_t t = 0; t < surface.triangles.size(); ++t) now.parent.push_back(static_cast<int>(t));
  while (longest > 0) {
    const auto fresh = bisect(now, longest);
    if (fresh.empty()) break;
    for (const auto& [a, b] : fresh) {
      std::map<int, double> mean;
      for (const int end : {a, b})
        for (const auto& [v, w] : weights[static_cast<size_t>(end)]) mean[v] += 0.5 * w;
      weights.push_back(std::move(mean));
    }
  }
  now.mesh.cut_from = surface.triangles;
  now.mesh.cut_weights = rows_of(weights, given);
  return now;
}

}  // namespace hookeye::detail
