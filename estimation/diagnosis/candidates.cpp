#include "estimation/diagnosis/candidates.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <set>

#include "estimation/effects/catalogue.h"
#include "estimation/evaluation/gram.h"

namespace hookeye {

namespace {

/// Those that have parameters of their own: the other camera, the load of another example.
Ingredients not_yet_in(const ModelForm& form, const Ingredients& candidates) {
  std::set<std::string> taken;
  for (const Parameter& parameter : form.parameters()) taken.insert(parameter.name);
  Ingredients out;
  for (const auto& candidate : candidates) {
    const auto own = candidate->parameters();
    if (std::none_of(own.begin(), own.end(), [&](const auto& p) { return taken.count(p.name); }))
      out.push_back(candidate);
  }
  return out;
}

/// Those of this name in the model.
Ingredients standing_of(const ModelForm& form, const std::string& name) {
  Ingredients out;
  std::copy_if(form.ingredients.begin(), form.ingredients.end(), std::back_inserter(out),
               [&](const auto& ingredient) { return ingredient->name() == name; });
  return out;
}

/// Lengths of the columns of H, the same for those parameters of an ingredient that share a unit
/// and a typical size: x, y and z, which a frame mixes.
VectorXd common_lengths(const ModelForm& base, const std::vector<Candidate>& candidates,
                        const Eigen::MatrixXd& H) {
  VectorXd out = lengths(H);
  Eigen::Index first = 0;
  const auto share = [&](const std::vector<Parameter>& parameters) {
    const VectorXd own = out.segment(first, static_cast<Eigen::Index>(parameters.size()));
    for (const Parameter& one : parameters) {
      double square = 0.0;
      int count = 0;
      for (size_t i = 0; i < parameters.size(); ++i) {
        const Parameter& other = parameters[i];
        if (other.unit != one.unit || other.typical != one.typical) continue;
        square += own[i] * own[i];
        ++count;
      }
      out[first++] = std::sqrt(square / count);
    }
  };
  for (const auto& ingredient : base.ingredients) share(ingredient->parameters());
  for (const Candidate& candidate : candidates) share(candidate.ingredient->parameters());
  return out;
}

}  // namespace

std::vector<Candidate> collect_candidates(const Fitted& fitted, const DiagnosisOptions& options,
                                          std::vector<EffectScore>& idle) {
  const Model model = realised(fitted);
  std::vector<Candidate> all;
  int column = fitted.form.size();
  std::vector<const Effect*> tested(catalogue().begin(), catalogue().end());
  tested.insert(tested.end(), options.also.begin(), options.also.end());
  for (const Effect* effect : tested) {
    if (std::count(options.without.begin(), options.without.end(), effect->name())) continue;
    std::string why_not;
    const Ingredients standing = standing_of(fitted.form, effect->name());
    Ingredients candidates =
        standing.empty()
            ? effect->candidates(model, &why_not)
            : not_yet_in(fitted.form, effect->candidates_beside(model, standing, &why_not));
    if (!standing.empty() && candidates.empty()) why_not = "already in the model";
    if (candidates.empty()) {
      EffectScore score;
      score.effect = effect->name();
      score.testable = false;
      score.why_not = why_not.empty() ? "does not apply to this capture" : why_not;
      idle.push_back(std::move(score));
      continue;
    }
    for (const auto& ingredient : candidates) {
      const auto parameters = ingredient->parameters();
      Candidate one{effect, ingredient, {}};
      one.hypothesis.first = column;
      one.hypothesis.count = static_cast<int>(parameters.size());
      one.hypothesis.typical.resize(parameters.size());
      for (size_t i = 0; i < parameters.size(); ++i)
        one.hypothesis.typical[i] =
            parameters[i].positive ? std::abs(parameters[i].value) : parameters[i].typical;
      one.hypothesis.one_sided = parameters.size() == 1 && parameters[0].low >= parameters[0].value;
      if (parameters.size() > 1)
        for (const Parameter& parameter : parameters)
          one.hypothesis.grows.push_back(parameter.low >= parameter.value);
      if (parameters.size() == 1) {
        one.hypothesis.least = parameters[0].low - parameters[0].value;
        one.hypothesis.most = parameters[0].high - parameters[0].value;
      }
      column += one.hypothesis.count;
      all.push_back(std::move(one));
    }
  }
  return all;
}

std::map<std::string, double> by_effect(const std::vector<Candidate>& candidates,
                                        const VectorXd& evidence) {
  std::map<std::string, std::vector<double>> lists;
  for (size_t i = 0; i < candidates.size(); ++i)
    lists[candidates[i].effect->name()].push_back(evidence[i]);
  std::map<std::string, double> out;
  for (const auto& [name, list] : lists)
    out[name] = log_mean_exp(Eigen::Map<const VectorXd>(list.data(), list.size()));
  return out;
}

std::vector<double> simulate_null(const ModelForm& base, const std::vector<Candidate>& candidates,
                                  const std::vector<ProjectedHypothesis>& projected,
                                  const DiagnosisSums& sums, const DiagnosisOptions& options) {
  const Eigen::MatrixXd root = square_root(
      sums.null_noise, common_lengths(base, candidates, sums.null_noise), sums.effective.s);
  const double r2 = sums.effective.count * sums.effective.floor2;
  std::mt19937 engine(options.seed);
  std::normal_distribution<double> normal;
  std::vector<double> largest;
  const int draws = options.null_simulations.value_or(base.scene->limits->diagnosis.simulations);
  for (int b = 0; b < draws; ++b) {
    VectorXd white(root.cols());
    for (double& x : white) x = normal(engine);
    const VectorXd s = root * white;
    VectorXd evidence(candidates.size());
    for (size_t i = 0; i < candidates.size(); ++i)
      evidence[i] = log_evidence(projected[i], s, r2, sums.effective.count, sums.effective.floor2);
    double most = 0.0;
    for (const auto& [name, value] : by_effect(candidates, evidence)) most = std::max(most, value);
    largest.push_back(most);
  }
  std::sort(largest.begin(), largest.end());
  return largest;
}

void find_confusions(const Eigen::MatrixXd& H, const std::vector<ProjectedHypothesis>& projected,
                     const std::map<std::string, size_t>& best, double least,
                     std::vector<EffectScore>& scores) {
  for (auto& score : scores) {
    if (!score.testable || score.evidence <= 0.0) continue;
    const ProjectedHypothesis& mine = projected[best.at(score.effect)];
    VectorXd t = score.values;
    const auto parameters = score.best->parameters();
    for (int i = 0; i < t.size(); ++i) t[i] -= parameters[i].value;
    const double length = t.dot(mine.M * t);
    if (length <= 0.0) continue;
    for (const auto& other : scores) {
      if (!other.testable || other.effect == score.effect || other.evidence <= 0.0) continue;
      const ProjectedHypothesis& theirs = projected[best.at(other.effect)];
      const VectorXd projection = theirs.projected_score(H.middleCols(mine.first, t.size()) * t);
      const double imitated = projection.dot(theirs.inverse() * projection);
      const double cosine = std::sqrt(std::clamp(imitated / length, 0.0, 1.0));
      // A wrong cause at cosine 0.9 still removes 80 % of the removable error.
      if (cosine > least) score.confused_with.push_back({other.effect, cosine});
    }
    std::sort(score.confused_with.begin(), score.confused_with.end(),
              [](auto& a, auto& b) { return a.cosine > b.cosine; });
  }
}

}  // namespace hookeye
