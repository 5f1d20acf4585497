#include "estimation/fit/evidence.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/distributions.h"
#include "estimation/evaluation/gram.h"

namespace hookeye {

namespace {

/// Share of a mode's sum of squares that the base columns must leave to be known, ten times what
/// their inverse errs by (kInverted). A mode with less is a motion of the base columns; what would
/// be told of it is what the fit left undone along them.
constexpr double kOwn = 1e-5;

/// |r|^2 with which the noise is left once the hypothesis has taken its part. Sums over cells hold
/// motion and brightness; a blur takes away more than they have, and without this all that takes
/// more would be of one evidence, from whichever example on.
double with_noise_left(const ProjectedHypothesis& hypothesis, const Eigen::VectorXd& s, double r2,
                       double count, double floor2) {
  return std::max(r2, hypothesis.fall(s) + floor2 * count);
}

}  // namespace

ProjectedHypothesis project(const Eigen::MatrixXd& H, int base, const Hypothesis& hypothesis) {
  ProjectedHypothesis out;
  out.first = hypothesis.first;
  out.base = base;
  out.typical = hypothesis.typical;
  out.one_sided = hypothesis.one_sided && hypothesis.count == 1;
  if (hypothesis.count == 1) out.least = hypothesis.least, out.most = hypothesis.most;
  if (out.one_sided) out.least = 0.0;
  const auto H_ac = H.block(0, hypothesis.first, base, hypothesis.count);
  out.to_base = pseudo_inverse(H.topLeftCorner(base, base)) * H_ac;
  const auto D = hypothesis.typical.asDiagonal();
  const Eigen::MatrixXd before =
      D * H.block(hypothesis.first, hypothesis.first, hypothesis.count, hypothesis.count) * D;
  Eigen::MatrixXd after = before - D * H_ac.transpose() * out.to_base * D;
  for (size_t i = 0; i < hypothesis.held.size(); ++i)
    if (hypothesis.held[i]) after.row(i).setZero(), after.col(i).setZero();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (after + after.transpose()));
  out.modes = eigen.eigenvectors();
  out.eigenvalues = eigen.eigenvalues();
  for (Eigen::Index i = 0; i < out.eigenvalues.size(); ++i)
    if (out.eigenvalues[i] <= kOwn * out.modes.col(i).dot(before * out.modes.col(i)))
      out.eigenvalues[i] = 0.0, out.modes.col(i).setZero();
  const Eigen::MatrixXd back = D.inverse() * out.modes;
  out.M = back * out.eigenvalues.asDiagonal() * back.transpose();
  return out;
}

double ProjectedHypothesis::best_signal() const {
  return eigenvalues.size() ? eigenvalues.maxCoeff() : 0.0;
}

Eigen::VectorXd ProjectedHypothesis::projected_score(const Eigen::VectorXd& s) const {
  return s.segment(first, M.cols()) - to_base.transpose() * s.head(base);
}

Eigen::MatrixXd ProjectedHypothesis::inverse() const {
  const Eigen::MatrixXd forth = typical.asDiagonal() * modes;
  const Eigen::VectorXd of_modes =
      (eigenvalues.array() > 0.0).select(eigenvalues.cwiseInverse(), 0.0);
  return forth * of_modes.asDiagonal() * forth.transpose();
}

Eigen::VectorXd ProjectedHypothesis::step(const Eigen::VectorXd& s) const {
  Eigen::VectorXd score = modes.transpose() * typical.cwiseProduct(projected_score(s));
  const double no_signal = 1e-9 * std::max(best_signal(), 1e-300);
  for (int i = 0; i < score.size(); ++i)
    score[i] = eigenvalues[i] > no_signal ? -score[i] / eigenvalues[i] : 0.0;
  Eigen::VectorXd t = typical.cwiseProduct(modes * score);
  return t.cwiseMax(least).cwiseMin(most);
}

Eigen::VectorXd ProjectedHypothesis::step_within(const Eigen::VectorXd& s,
                                                 const Eigen::VectorXd& low,
                                                 const Eigen::VectorXd& high) const {
  Eigen::VectorXd t = step(s);
  const auto bounded = [&] { return t.cwiseMax(low).cwiseMin(high).eval(); };
  Eigen::VectorXd open = Eigen::VectorXd::Ones(t.size());
  for (Eigen::Index held = 0; held < t.size(); ++held) {
    Eigen::Index worst;
    const Eigen::VectorXd out = open.cwiseProduct(t - bounded()).cwiseQuotient(typical);
    if (out.cwiseAbs().maxCoeff(&worst) == 0.0) break;
    t[worst] = bounded()[worst];
    open[worst] = 0.0;
    t -= open.cwiseProduct(t);
    const Eigen::VectorXd slope = open.cwiseProduct(projected_score(s) + M * t);
    t -= pseudo_inverse(open.asDiagonal() * M * open.asDiagonal()) * slope;
  }
  return t;
}

double ProjectedHypothesis::fall(const Eigen::VectorXd& s) const {
  const Eigen::VectorXd t = step(s);
  return -2.0 * t.dot(projected_score(s)) - t.dot(M * t);
}

Hypothesis within_bounds(const Eigen::MatrixXd& H, int base, const Hypothesis& hypothesis,
                         const Eigen::VectorXd& s) {
  Hypothesis out = hypothesis;
  if (out.grows.empty()) return out;
  for (int left = 0; left < out.count; ++left) {
    const Eigen::VectorXd step = project(H, base, out).step(s);
    int worst = -1;
    for (int i = 0; i < out.count; ++i)
      if (out.grows[i] && step[i] < 0.0 &&
          (worst < 0 || step[i] / out.typical[i] < step[worst] / out.typical[worst]))
        worst = i;
    if (worst < 0) break;
    out.held.resize(out.count, false);
    out.held[worst] = true;
  }
  return out;
}

double bayes_information(const ProjectedHypothesis& hypothesis, const Eigen::VectorXd& s, double r2,
                         double count, double floor2) {
  r2 = with_noise_left(hypothesis, s, r2, count, floor2);
  const auto likelihood = [&](double left) {
    const double noise = std::max(floor2, left / count);
    return -0.5 * count * std::log(noise) - 0.5 * left / noise;
  };
  const auto dof = static_cast<double>((hypothesis.eigenvalues.array() > 0.0).count());
  return likelihood(std::max(0.0, r2 - hypothesis.fall(s))) - likelihood(r2) -
         0.5 * dof * std::log(std::max(count, 2.0));
}

double log_evidence_of_told_noise(const ProjectedHypothesis& hypothesis, const Eigen::VectorXd& s,
                                  double r2, double count, double noise2) {
  const double noise =
      std::max(noise2, std::max(0.0, r2 - hypothesis.fall(s)) / std::max(count, 1.0));
  const Eigen::VectorXd score =
      hypothesis.modes.transpose() * hypothesis.typical.cwiseProduct(hypothesis.projected_score(s));
  double best = 0.0;  // prior variance 0: the effect is not there
  for (int k = -16; k <= 16; ++k) {
    const double prior = std::pow(10.0, 0.5 * k);  // variance over typical^2
    double value = 0.0;
    for (int i = 0; i < score.size(); ++i)
      value += 0.5 * score[i] * score[i] * prior /
                   (noise * (prior * hypothesis.eigenvalues[i] + noise)) -
               0.5 * std::log1p(prior * hypothesis.eigenvalues[i] / noise);
    best = std::max(best, value);
  }
  return best;
}

double log_evidence(const ProjectedHypothesis& hypothesis, const Eigen::VectorXd& s, double r2,
                    double count, double floor2, Eigen::VectorXd* mean) {
  if (mean) mean->setZero(hypothesis.typical.size());
  r2 = with_noise_left(hypothesis, s, r2, count, floor2);
  const double null_noise = std::max(floor2, r2 / count);
  const double null = -0.5 * count * std::log(null_noise) - 0.5 * r2 / null_noise;
  if (hypothesis.one_sided && hypothesis.projected_score(s)[0] >= 0.0) return 0.0;
  const Eigen::VectorXd score =
      hypothesis.modes.transpose() * hypothesis.typical.cwiseProduct(hypothesis.projected_score(s));
  // a step that its bound cuts short gains what it gains there
  const double bounded =
      score.size() == 1 ? hypothesis.fall(s) : std::numeric_limits<double>::infinity();
  double best = 0.0;  // prior variance 0: the effect is not there
  for (int k = -16; k <= 16; ++k) {
    const double prior = std::pow(10.0, 0.5 * k);  // variance over typical^2
    double noise = null_noise, gain = 0.0;
    for (int iteration = 0; iteration < 3; ++iteration) {
      gain = 0.0;
      for (int i = 0; i < score.size(); ++i)
        gain += score[i] * score[i] * prior / (prior * hypothesis.eigenvalues[i] + noise);
      gain = std::min(gain, bounded);
      noise = std::max(floor2, (r2 - gain) / count);
    }
    double log_det = 0.0;
    for (int i = 0; i < score.size(); ++i)
      log_det += std::log1p(prior * hypothesis.eigenvalues[i] / noise);
    const double value =
        -0.5 * count * std::log(noise) - 0.5 * std::max(r2 - gain, 0.0) / noise - 0.5 * log_det;
    const double over = value - null + (hypothesis.one_sided ? std::log(2.0) : 0.0);
    if (over <= best) continue;
    best = over;
    if (!mean) continue;
    const Eigen::VectorXd shrunk =
        -prior * score.cwiseQuotient((prior * hypothesis.eigenvalues.array() + noise).matrix());
    *mean = hypothesis.typical.cwiseProduct(hypothesis.modes * shrunk);
  }
  return best;
}

double log_mean_exp(const Eigen::VectorXd& values) {
  const double largest = values.maxCoeff();
  return largest + std::log((values.array() - largest).exp().mean());
}

}  // namespace hookeye
