#include "estimation/evaluation/normal_equations.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/distributions.h"

namespace hookeye {

NormalEquations normal_equations(const Evaluation& evaluation, bool held_out) {
  NormalEquations sums;
  sums.JtJ.setZero(evaluation.columns, evaluation.columns);
  sums.Jtr.setZero(evaluation.columns);
  for (const auto& example : evaluation.examples) {
    if (example.held_out != held_out) continue;
    for (const auto& photo : example.photos) {
      sums.JtJ += photo.sums.JtJ;
      sums.Jtr += photo.sums.Jtr;
      sums.r2 += photo.sums.r2;
    }
    for (const auto& measured : example.measured) {
      const double weight = measured.is_field() ? 1.0 : evaluation.measured_weight;
      sums.JtJ += weight * measured.J.transpose() * measured.J;
      sums.Jtr += weight * measured.J.transpose() * measured.r;
      sums.r2 += weight * measured.r.squaredNorm();
    }
  }
  return sums;
}

std::vector<bool> of_held_out(const Capture& capture, const std::vector<Parameter>& parameters) {
  std::vector<bool> own;
  for (const auto& parameter : parameters)
    own.push_back(parameter.example >= 0 && capture.examples[parameter.example].validate);
  return own;
}

Eigen::MatrixXd part_of(const Eigen::MatrixXd& H, const std::vector<bool>& keep) {
  VectorXd kept(keep.size());
  for (size_t i = 0; i < keep.size(); ++i) kept[i] = keep[i] ? 1.0 : 0.0;
  return kept.asDiagonal() * H * kept.asDiagonal();
}

namespace {

/// -1: at its lower bound, 1: at the upper one, 0: free to move. (A bound comes back from its
/// logarithm a little off.)
int bound_at(const Scaling& scaling, int i, double value) {
  const Parameter& parameter = scaling.parameters[i];
  const double near = 1e-9 * (parameter.positive ? std::abs(value) : parameter.typical);
  return value <= parameter.low + near ? -1 : value >= parameter.high - near ? 1 : 0;
}

}  // namespace

NormalEquations within_bounds(const NormalEquations& sums, const Scaling& scaling,
                              const VectorXd& p) {
  const auto n = static_cast<int>(p.size());
  std::vector<int> bound(n);
  std::vector<bool> moves(n);
  for (int i = 0; i < n; ++i) bound[i] = bound_at(scaling, i, p[i]), moves[i] = bound[i] == 0;
  const VectorXd scale = scaling.dp_dx(p);
  const auto of_moving = [&] {
    NormalEquations out = sums;
    out.JtJ = part_of(sums.JtJ, moves);
    for (int i = 0; i < n; ++i)
      if (!moves[i]) out.Jtr[i] = 0.0;
    return out;
  };
  for (int round = 0; round < 3 * n; ++round) {
    const CondensedResidual condensed = condense(of_moving(), scale);
    const VectorXd dx = -condensed.R.completeOrthogonalDecomposition().solve(condensed.z);
    int leaves = -1, enters = -1;  // the one that goes farthest out; the one that is held most
    const VectorXd g = scale.cwiseProduct(sums.Jtr + sums.JtJ * scale.cwiseProduct(dx));
    for (int i = 0; i < n; ++i) {
      if (bound[i] == 0) continue;
      if (moves[i] && bound[i] * dx[i] > 0.0 &&
          (leaves < 0 || std::abs(dx[i]) > std::abs(dx[leaves])))
        leaves = i;
      if (!moves[i] && bound[i] * g[i] > 0.0 &&
          (enters < 0 || std::abs(g[i]) > std::abs(g[enters])))
        enters = i;
    }
    if (leaves >= 0)
      moves[leaves] = false;
    else if (enters >= 0)
      moves[enters] = true;
    else
      break;
  }
  return of_moving();
}

CondensedResidual condense(const NormalEquations& sums, const VectorXd& scale) {
  const Eigen::MatrixXd H = scale.asDiagonal() * sums.JtJ * scale.asDiagonal();
  const VectorXd g = scale.cwiseProduct(sums.Jtr);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(H);
  const double floor = 1e-14 * std::max(eigen.eigenvalues().maxCoeff(), 1e-300);
  const VectorXd root = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  CondensedResidual out;
  out.R = root.asDiagonal() * eigen.eigenvectors().transpose();
  out.z = eigen.eigenvectors().transpose() * g;
  for (int i = 0; i < out.z.size(); ++i)
    out.z[i] = eigen.eigenvalues()[i] > floor ? out.z[i] / root[i] : 0.0;
  out.rho = std::sqrt(std::max(0.0, sums.r2 - out.z.squaredNorm()));
  return out;
}

bool is_modulus(const Parameter& one) {
  return one.positive && (one.unit.ends_with("Pa") || one.unit.ends_with("^2"));
}

namespace {

/// Whether the direction moves parameter i by a tenth of what it moves most.
bool moves(const VectorXd& direction, Eigen::Index i) {
  return std::abs(direction[i]) >= 0.1 * direction.cwiseAbs().maxCoeff();
}

/// "mu", or "mu together with kappa": what a direction without information moves.
std::string name_direction(const std::vector<Parameter>& parameters, const VectorXd& direction) {
  std::vector<std::string> names;
  for (size_t i = 0; i < parameters.size(); ++i)
    if (moves(direction, static_cast<Eigen::Index>(i))) names.push_back(parameters[i].name);
  return fmt::format("not determined by this capture: {}", fmt::join(names, " together with "));
}

/// The directions without information, a sentence each. No force is known where all moduli may grow
/// by one factor and no other direction moves any: then their ratios are, and that is said.
std::vector<std::string> name_directions(const std::vector<Parameter>& parameters,
                                         const std::vector<VectorXd>& directions) {
  std::vector<Eigen::Index> moduli;
  std::vector<std::string> names;
  for (size_t i = 0; i < parameters.size(); ++i)
    if (is_modulus(parameters[i])) {
      moduli.push_back(static_cast<Eigen::Index>(i));
      names.push_back(parameters[i].name);
    }
  const auto moves_any = [&](const VectorXd& v) {
    return std::any_of(moduli.begin(), moduli.end(), [&](Eigen::Index i) { return moves(v, i); });
  };
  const auto only_scale = [&](const VectorXd& v) {
    if (moduli.empty()) return false;
    double rest = v.squaredNorm();
    for (const auto i : moduli) rest -= v[i] * v[i];
    return rest < 0.01 * v.squaredNorm() &&
           std::all_of(moduli.begin(), moduli.end(), [&](Eigen::Index i) {
             return std::abs(v[i] / v[moduli.front()] - 1.0) < 0.1;
           });
  };
  const auto of_moduli = std::count_if(directions.begin(), directions.end(), moves_any);
  std::vector<std::string> out;
  for (const VectorXd& v : directions) {
    const std::string sentence =
        of_moduli == 1 && only_scale(v)
            ? fmt::format("stiffness scale not determined; only ratios ({})",
                          fmt::join(names, ", "))
            : name_direction(parameters, v);
    if (std::find(out.begin(), out.end(), sentence) == out.end()) out.push_back(sentence);
  }
  return out;
}

/// One photo's (all its channels), one field's, or one sensor's, share of the normal equations at
/// the fitted values.
struct Cluster {
  Eigen::MatrixXd H;
  VectorXd s;          ///< J^T r; their sum vanishes
  bool photo = false;  ///< or a field
};

/// By how much the scatter of the clusters exceeds what a covariance makes of it, as a factor on
/// the variance of a parameter, and how many clusters tell so in effect. Cluster-robust (Liang and
/// Zeger 1986): what a renderer or a lens gets wrong moves together in one photo, by a few
/// thousandths of a pixel that no correlation between cells shows, and otherwise in the next.
struct Excess {
  double variance = 1.0, clusters = 0.0;
  bool of_photos = false;  ///< most of what is known of the parameter
  bool known() const { return clusters >= 2.0; }
  /// On the standard deviation. Few clusters know their scatter badly: Student's quantile for as
  /// many as there are in effect, over the normal one that intervals are made with.
  double factor() const {
    if (!known()) return 1.0;
    const double student = student_quantile(0.975, clusters - 1.0) / kNormal95;
    return std::max(1.0, student * std::sqrt(variance));
  }
};

Excess excess_of_scatter(const std::vector<Cluster>& clusters, const Eigen::MatrixXd& inverse,
                         const Eigen::MatrixXd& covariance, Eigen::Index i) {
  if (covariance(i, i) <= 0.0) return {};
  const VectorXd row = inverse.row(i);
  double scatter = 0.0, weight = 0.0, weight2 = 0.0, photos = 0.0;
  for (const Cluster& one : clusters) {
    const double w = row.dot(one.H * row);
    scatter += std::pow(row.dot(one.s), 2);
    weight += w;
    weight2 += w * w;
    photos += one.photo ? w : 0.0;
  }
  Excess out;
  out.clusters = weight2 > 0.0 ? weight * weight / weight2 : 0.0;
  out.of_photos = photos > 0.5 * weight;
  if (out.known()) out.variance = out.clusters / (out.clusters - 1.0) * scatter / covariance(i, i);
  return out;
}

/// The factors of all parameters. One that a single photo knows (a camera that was knocked before
/// it) has taken on what moves together there, and nothing is left to tell by how much: it takes
/// the mean excess of those that several photos know.
VectorXd factors_of_scatter(const std::vector<Cluster>& clusters, const Eigen::MatrixXd& inverse,
                            const Eigen::MatrixXd& covariance) {
  std::vector<Excess> all;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i)
    all.push_back(excess_of_scatter(clusters, inverse, covariance, i));
  Excess mean{0.0, 0.0};
  double known = 0.0;
  for (const Excess& one : all)
    if (one.known() && one.of_photos)
      mean.variance += one.variance, mean.clusters = std::max(mean.clusters, one.clusters), ++known;
  mean.variance /= std::max(1.0, known);
  VectorXd out(covariance.rows());
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const Excess& own = all[static_cast<size_t>(i)];
    out[i] = own.known() || !own.of_photos ? own.factor() : mean.factor();
  }
  return out;
}

}  // namespace

ParameterCovariance parameter_covariance(const Evaluation& evaluation,
                                         const std::vector<Parameter>& parameters,
                                         const VectorXd& p) {
  const int n = static_cast<int>(parameters.size());
  const Scaling scaling{parameters};
  const VectorXd scale = scaling.dp_dx(p);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n), V = H;
  ParameterCovariance out{H, H, {}, std::vector<bool>(n, false)};
  if (n == 0) return out;  // nothing may move: a model that is only looked at
  std::vector<Cluster> clusters;
  for (const auto& example : evaluation.examples) {
    std::vector<bool> counts(n, !example.held_out);
    for (int i = 0; i < n; ++i)
      if (parameters[i].example == example.example) counts[i] = true;
    auto add = [&](const Eigen::MatrixXd& Hk, VectorXd sk, double inflation, bool photo,
                   bool same_cluster) {
      const Eigen::MatrixXd counted = part_of(Hk, counts);
      for (int i = 0; i < n; ++i)
        if (!counts[i]) sk[i] = 0.0;
      H += counted;
      V += inflation * counted;
      if (!same_cluster)
        clusters.push_back({Eigen::MatrixXd::Zero(n, n), VectorXd::Zero(n), photo});
      clusters.back().H += scale.asDiagonal() * counted * scale.asDiagonal();
      clusters.back().s += scale.cwiseProduct(sk);
    };
    const auto statistics = photo_statistics(example.photos);
    for (size_t k = 0; k < example.photos.size(); ++k) {
      const auto& photo = example.photos[k];
      add(photo.sums.JtJ.topLeftCorner(n, n), photo.sums.Jtr.head(n), statistics[k].inflation, true,
          k > 0 && example.photos[k - 1].photo == photo.photo);
    }
    for (const auto& measured : example.measured) {
      const Eigen::MatrixXd J = measured.J.leftCols(n);
      if (measured.is_field()) {
        add(J.transpose() * J, J.transpose() * measured.r, measured.inflation, true, false);
        continue;
      }
      const double w = evaluation.measured_weight;
      add(w * J.transpose() * J, w * J.transpose() * measured.r,
          w * std::max(1.0, measured.r.squaredNorm() / measured.size()), false, false);
    }
  }
  H = scale.asDiagonal() * H * scale.asDiagonal();
  V = scale.asDiagonal() * V * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(H);
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(n, n), unknown = inverse;
  std::vector<VectorXd> without;
  for (int i = 0; i < n; ++i) {
    // A standard deviation above 30 (a factor e^30, or 30 times what matters) determines nothing.
    const VectorXd v = eigen.eigenvectors().col(i);
    if (eigen.eigenvalues()[i] < 1.0 / 900.0) {
      without.push_back(v);
      unknown += 900.0 * v * v.transpose();
      for (int k = 0; k < n; ++k) out.open[k] = out.open[k] || moves(v, k);
      continue;
    }
    inverse += v * v.transpose() / eigen.eigenvalues()[i];
  }
  out.directions = name_directions(parameters, without);
  const Eigen::MatrixXd covariance = inverse * V * inverse;
  const VectorXd wider = scale.cwiseProduct(factors_of_scatter(clusters, inverse, covariance));
  out.determined = wider.asDiagonal() * covariance * wider.asDiagonal();
  out.undetermined = scale.asDiagonal() * unknown * scale.asDiagonal();
  return out;
}

}  // namespace hookeye
