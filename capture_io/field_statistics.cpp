// How a field's residuals hang together over the surface.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "capture_io/capture.h"

namespace hookeye {

namespace {

/// Sums over pieces of surface of residuals over their noise, and how many points those are worth.
struct PieceSums {
  Eigen::MatrixXd r;       ///< components x pieces
  Eigen::VectorXd points;  ///< by piece
  Eigen::Matrix3Xi at;
};

PieceSums piece_sums(const FieldSpec& field, const Eigen::VectorXd& r) {
  PieceSums out{Eigen::MatrixXd::Zero(field.components, field.pieces),
                Eigen::VectorXd::Zero(field.pieces), field.piece_at};
  for (Eigen::Index k = 0; k < field.alike.size(); ++k) {
    const int piece = field.piece[static_cast<size_t>(k)];
    out.r.col(piece) +=
        r.segment(field.components * k, field.components) / std::sqrt(field.alike[k]);
    out.points[piece] += 1.0 / field.alike[k];
  }
  return out;
}

/// Pieces of twice the edge.
PieceSums in_larger_pieces(const PieceSums& sums) {
  std::map<std::array<int, 3>, Eigen::Index> index;
  std::vector<Eigen::Index> of(static_cast<size_t>(sums.at.cols()));
  for (Eigen::Index p = 0; p < sums.at.cols(); ++p)
    of[static_cast<size_t>(p)] =
        index
            .try_emplace({sums.at(0, p) / 2, sums.at(1, p) / 2, sums.at(2, p) / 2},
                         static_cast<Eigen::Index>(index.size()))
            .first->second;
  const auto count = static_cast<Eigen::Index>(index.size());
  PieceSums out{Eigen::MatrixXd::Zero(sums.r.rows(), count), Eigen::VectorXd::Zero(count),
                Eigen::Matrix3Xi(3, count)};
  for (Eigen::Index p = 0; p < sums.at.cols(); ++p) {
    const Eigen::Index to = of[static_cast<size_t>(p)];
    out.r.col(to) += sums.r.col(p);
    out.points[to] += sums.points[p];
    out.at.col(to) = sums.at.col(p) / 2;
  }
  return out;
}

/// Sum over lags of the squared autocorrelation of the sums over pieces.
double sum_of_squared_correlations(const PieceSums& sums) {
  struct Lag {
    double product = 0.0, pairs = 0.0;  // each pair once
  };
  std::map<std::array<int, 3>, Lag> lags;
  const auto components = static_cast<double>(sums.r.rows());
  const Eigen::MatrixXd z = sums.r * sums.points.cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::Index n = z.cols();
  const double count = components * static_cast<double>(n), variance = z.squaredNorm() / count;
  for (Eigen::Index p = 0; p < n; ++p)
    for (Eigen::Index q = 0; q < p; ++q) {
      Eigen::Vector3i d = sums.at.col(p) - sums.at.col(q);
      const auto first = std::find_if(d.begin(), d.end(), [](int x) { return x != 0; });
      if (first != d.end() && *first < 0) d = -d;  // seen from the other one it is the same
      Lag& lag = lags[{d.x(), d.y(), d.z()}];
      lag.product += z.col(p).dot(z.col(q));
      lag.pairs += components;
    }
  // One that is zero scatters by the sum sought over its pairs (Bartlett 1946), so that
  // sum = 1 + 2/count of all lags' (rho^2 pairs - sum).
  double found = 1.0;
  for (const auto& [at, lag] : lags)
    found += 2.0 / count * std::pow(lag.product / variance, 2) / lag.pairs;
  return std::max(1.0, found / (1.0 + 2.0 / count * static_cast<double>(lags.size())));
}

}  // namespace

double FieldSpec::inflation(const VectorXd& r) const {
  return std::max(1.0, piece_sums(*this, r).r.squaredNorm() / numbers());
}

double FieldSpec::effective(const VectorXd& r) const {
  constexpr Eigen::Index kMostPieces = 500;  // an eighth of a million pairs
  const double count = numbers(), variance = r.squaredNorm() / count;
  if (!(variance > 0.0)) return count;
  PieceSums sums = piece_sums(*this, r);
  while (sums.points.size() > kMostPieces) sums = in_larger_pieces(sums);
  // Of points of one piece: variance of their sum over that of as many free ones.
  const double points = sums.points.squaredNorm() / sums.points.sum();
  const double together = sums.r.squaredNorm() / (count * variance);
  const double within = points > 1.0 ? std::pow(together - 1.0, 2) / (points - 1.0) : 0.0;
  const double between = together * together / points * (sum_of_squared_correlations(sums) - 1.0);
  return std::clamp(count / (1.0 + within + between), 1.0, count);
}

}  // namespace hookeye
