#include "estimation/plan/plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "estimation/plan/plan_prediction.h"

namespace hookeye {

double Separation::angle_deg() const {
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / EIGEN_PI;
}

std::vector<std::string> confused_effects(const Diagnosis& diagnosis) {
  std::vector<std::string> out = leaders(diagnosis);
  if (out.size() > kMostConfused) out.resize(kMostConfused);
  if (out.size() != 1) return out;
  for (const auto& score : diagnosis.effects)
    if (score.effect == out.front())
      for (const auto& other : score.confused_with)
        if (out.size() < kMostConfused) out.push_back(other.effect);
  return out;
}

namespace {

/// x of the least |A x + b| from the normal equations, in columns scaled to unit length; columns
/// without information stay zero.
VectorXd imitate(const Eigen::MatrixXd& H, const VectorXd& g) {
  const VectorXd scale =
      H.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0; });
  const Eigen::MatrixXd unit = scale.asDiagonal() * H * scale.asDiagonal();
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(1e-10);
  return -scale.cwiseProduct(solver.compute(unit).solve(scale.cwiseProduct(g)));
}

struct Imitation {
  double left = 0.0;  ///< |signature + what imitates it|^2
  VectorXd step;      ///< over all columns
};

/// The best that `columns` can do against `step`.
Imitation imitation(const Eigen::MatrixXd& H, const VectorXd& step,
                    const std::vector<int>& columns) {
  const VectorXd Hs = H * step;
  Imitation out{step.dot(Hs), step};
  if (columns.empty()) return out;
  const VectorXd x = imitate(H(columns, columns), Hs(columns));
  for (size_t i = 0; i < columns.size(); ++i) out.step[columns[i]] += x[static_cast<int>(i)];
  out.left = std::max(0.0, out.step.dot(H * out.step));
  return out;
}

struct Judged {
  Separation separation;
  VectorXd difference;  ///< the effect at its size minus its imitation, over all columns
};

Judged separate(const Prediction& prediction, const Eigen::MatrixXd& H, double count,
                const PlanHypothesis& a, const PlanHypothesis& b) {
  std::vector<int> columns(static_cast<size_t>(prediction.base));
  for (int i = 0; i < prediction.base; ++i) columns[i] = i;
  VectorXd step = VectorXd::Zero(H.rows());
  step.segment(a.first, a.step.size()) = a.step;
  const Imitation alone = imitation(H, step, columns);
  std::vector<int> with_rival = columns;
  for (int i = 0; i < b.step.size(); ++i) with_rival.push_back(b.first + i);
  Imitation both = imitation(H, step, with_rival);
  // A rival that may only grow is subtracted from the signature: it imitates with values below 0.
  if (b.one_sided && both.step[b.first] > 0.0) both = alone;
  Judged out;
  out.separation.effect = a.name;
  out.separation.rival = b.name;
  if (alone.left > 0.0)
    out.separation.cosine = std::sqrt(std::clamp(1.0 - both.left / alone.left, 0.0, 1.0));
  // what refit_score() would lose with the rival in the effect's place
  out.separation.margin = 0.5 * count * std::log1p(both.left / (count * prediction.noise));
  out.difference = both.step;
  return out;
}

/// The pair that is told apart worst, either of the two being the truth.
Judged worst_pair(const Prediction& prediction, const Eigen::MatrixXd& H, double count) {
  Judged worst;
  worst.separation.margin = std::numeric_limits<double>::infinity();
  for (const auto& a : prediction.confused)
    for (const auto& b : prediction.confused) {
      if (&a == &b) continue;
      Judged one = separate(prediction, H, count, a, b);
      if (one.separation.margin < worst.separation.margin) worst = std::move(one);
    }
  return worst;
}

/// A typical change of some parameter moves the photos by two standard deviations (diagnosis.cpp).
bool can_test(const Prediction& prediction, const Eigen::MatrixXd& H, const PlanHypothesis& one) {
  Hypothesis hypothesis;
  hypothesis.first = one.first;
  hypothesis.count = static_cast<int>(one.typical.size());
  hypothesis.typical = one.typical;
  return project(H, prediction.base, hypothesis).best_signal() >= 4.0;
}

std::string sentence_of(const PlanRating& rating, const Separation& now) {
  std::string text = rating.candidate.words;
  if (!rating.worst.effect.empty())
    text += fmt::format(
        ": {} and {} would differ by {:.2g} px there (most in '{}', {:.1f} times the noise); angle "
        "between them {:.0f} -> {:.0f} degrees, expected evidence {:.1f} -> {:.1f}",
        rating.worst.effect, rating.worst.rival, rating.px, rating.most, rating.chi,
        now.angle_deg(), rating.worst.angle_deg(), now.margin, rating.worst.margin);
  if (!rating.makes_testable.empty())
    text += fmt::format("{} would test {}", rating.worst.effect.empty() ? ":" : ";",
                        fmt::join(rating.makes_testable, ", "));
  return text;
}

PlanRating rate(const Prediction& prediction, const PredictedPhotos& photos,
                const Separation& now) {
  PlanRating out;
  out.candidate = photos.candidate;
  out.why_not = photos.why_not;
  if (!out.why_not.empty()) return out;
  out.photos = static_cast<int>(photos.views.size());
  const Eigen::MatrixXd H = prediction.H + photos.H;
  if (prediction.confused.size() > 1) {
    const Judged judged = worst_pair(prediction, H, prediction.count + photos.count);
    out.worst = judged.separation;
    const Difference difference = difference_of(photos, judged.difference);
    out.px = difference.px;
    out.chi = difference.chi;
    out.most = difference.most;
  }
  for (const auto& one : prediction.untestable)
    if (can_test(prediction, H, one)) out.makes_testable.push_back(one.name);
  out.sentence = sentence_of(out, now);
  return out;
}

std::string summary(const Plan& plan) {
  if (plan.confused.size() > 1) {
    const std::string known = fmt::format(
        "with these photos {} and {} stand at an angle of {:.0f} degrees, expected "
        "evidence between them {:.1f}",
        plan.now.effect, plan.now.rival, plan.now.angle_deg(), plan.now.margin);
    if (plan.ratings.empty() || !plan.ratings.front().why_not.empty())
      return known + "; no further load or view could be rated";
    const PlanRating& best = plan.ratings.front();
    if (best.worst.margin < plan.tie)
      return known + "; none of the further loads and views would separate them";
    return known + "; best: " + best.sentence;
  }
  // The diagnosis lists what is alike of all effects, be they there or not.
  const std::string alike =
      plan.alike
          ? " (what `confused with` lists would look alike if it were there: `--between A,B` "
            "plans for two of those)"
          : "";
  const std::string known =
      plan.leader.empty()
          ? fmt::format("no effect stands out, so there is none to tell from another{}", alike)
          : fmt::format("{} leads, and these photos tell it from all else{}", plan.leader, alike);
  if (plan.untestable.empty()) return known + ": no further load or view is needed";
  const bool helps = !plan.ratings.empty() && !plan.ratings.front().makes_testable.empty();
  return fmt::format("{}; {} cannot be tested with these photos{}", known,
                     fmt::join(plan.untestable, ", "),
                     helps ? "; best: " + plan.ratings.front().sentence
                           : " and none of the further loads and views would change that");
}

bool better(const PlanRating& a, const PlanRating& b) {
  if (a.why_not.empty() != b.why_not.empty()) return a.why_not.empty();
  if (a.worst.margin != b.worst.margin) return a.worst.margin > b.worst.margin;
  return a.makes_testable.size() > b.makes_testable.size();
}

}  // namespace

Result<Plan> plan(const Fitted& fitted, const Diagnosis& diagnosis, const PlanOptions& options) {
  Plan out;
  out.tie = diagnosis.limits().tie;
  out.confused = options.between.empty() ? confused_effects(diagnosis) : options.between;
  if (out.confused.size() < 2) out.confused.clear();
  if (const auto first = leaders(diagnosis); !first.empty()) out.leader = first.front();
  for (const auto& score : diagnosis.effects) out.alike = out.alike || !score.confused_with.empty();
  for (const auto& score : diagnosis.effects)
    if (!score.testable && score.best) out.untestable.push_back(score.effect);
  if (out.confused.empty() && out.untestable.empty()) {
    out.sentence = summary(out);
    return out;
  }
  auto result = predict(fitted, diagnosis, out.confused, out.untestable, options);
  if (!result) return failure_of(result);
  const Prediction& prediction = *result;
  if (prediction.confused.size() > 1)
    out.now = worst_pair(prediction, prediction.H, prediction.count).separation;
  for (const auto& photos : prediction.photos)
    out.ratings.push_back(rate(prediction, photos, out.now));
  std::stable_sort(out.ratings.begin(), out.ratings.end(), better);
  out.sentence = summary(out);
  return out;
}

}  // namespace hookeye
