#include "estimation/search/score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "core/distributions.h"
#include "estimation/diagnosis/diagnosis.h"
#include "estimation/effects/catalogue.h"
#include "estimation/effects/typical_sizes.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/model/model_key.h"
#include "estimation/search/refit_score.h"

namespace hookeye {

namespace {

/// Ingredients of a form that are effects of the catalogue, or stand for one (placebos).
std::vector<const Ingredient*> effects_of(const ModelForm& form) {
  std::vector<const Ingredient*> out;
  for (size_t i = base_form(form.scene).ingredients.size(); i < form.ingredients.size(); ++i)
    out.push_back(form.ingredients[i].get());
  return out;
}

/// "blob" of "blob 3 4 5 2.5": forms that differ by numbers are one, in another place.
std::string kind_of(const std::string& variant) {
  std::string spaced = variant, out;
  for (char& c : spaced)
    if (std::string("(),").find(c) != std::string::npos) c = ' ';
  std::istringstream words(spaced);
  for (std::string word; words >> word;) {
    char* end = nullptr;
    std::strtod(word.c_str(), &end);
    if (*end != '\0') out += word + " ";
  }
  return out;
}

double log_choose(int n, int k) {
  return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
}

ScoredModel::Column column_of(const Ingredient& ingredient, const Parameter& parameter, double x,
                              bool is_effect) {
  const Scaling scaling{{parameter}};
  ScoredModel::Column out;
  out.sensors_alone = sensors_alone(ingredient);
  out.at_bound =
      x <= scaling.to_x(0, parameter.low) + 1e-9 || x >= scaling.to_x(0, parameter.high) - 1e-9;
  const auto size = is_effect ? size_prior(ingredient.name(), parameter) : std::nullopt;
  if (!size) return out;
  out.mean = size->mean - x;
  out.deviation = size->deviation;
  out.one_sided = size->one_sided;
  return out;
}

/// Sums in the units of a fit.
void scale(const VectorXd& dp_dx, SeenPart& part) {
  part.H = dp_dx.asDiagonal() * part.H * dp_dx.asDiagonal();
  part.s = dp_dx.cwiseProduct(part.s);
}

/// A parameter on its bound stays there: that it would go on is no gain. It costs what it costs,
/// and shares nothing with the others. (With its slope alone taken out, columns that change the
/// same would seem to remove what it does, and more than there is: a density of held-out data above
/// that of perfect ones.)
void hold(const std::vector<ScoredModel::Column>& columns, std::vector<EffectiveSums>& groups) {
  for (EffectiveSums& group : groups)
    for (Eigen::Index i = 0; i < group.s.size(); ++i) {
      if (!columns[static_cast<size_t>(i)].at_bound) continue;
      const double own = group.H(i, i);
      group.s[i] = 0.0;
      group.H.row(i).setZero();
      group.H.col(i).setZero();
      group.H(i, i) = own;
    }
}

GaussianPrior prior_of(const ScoredModel& model, const std::vector<EffectiveSums>& all) {
  const auto m = static_cast<Eigen::Index>(model.columns.size());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(m, m);
  double numbers = 0.0, of_sensors = 0.0;
  for (size_t g = 0; g < all.size(); ++g) {
    H += all[g].H;
    numbers += all[g].count;
    if (g % 2 == 1) of_sensors += all[g].count;  // in_noise(): photos and fields, sensors
  }
  GaussianPrior out{VectorXd::Zero(m), Eigen::MatrixXd::Zero(m, m),
                    VectorXd::Constant(m, std::numeric_limits<double>::infinity())};
  const auto known_by = [&](Eigen::Index i) {
    return std::max(2.0,
                    model.columns[static_cast<size_t>(i)].sensors_alone ? of_sensors : numbers);
  };
  for (Eigen::Index i = 0; i < m; ++i) {
    const ScoredModel::Column& one = model.columns[static_cast<size_t>(i)];
    out.mean[i] = one.mean;
    if (one.one_sided) out.above[i] = std::max(0.0, -one.mean);
    if (one.deviation > 0.0) {
      out.precision(i, i) = 1.0 / (one.deviation * one.deviation);
      continue;
    }
    for (Eigen::Index k = 0; k < m; ++k)
      if (model.columns[static_cast<size_t>(k)].deviation <= 0.0)
        out.precision(i, k) = H(i, k) / std::sqrt(known_by(i) * known_by(k));
  }
  return out;
}

}  // namespace

std::string effects_in_words(const ModelForm& form) {
  std::string out;
  for (const Ingredient* one : effects_of(form))
    out += (out.empty() ? "" : ", ") + key_of(*one).words();
  return out;
}

double ModelPrices::log_prior(const ModelForm& form) const {
  std::set<std::string> names;
  double out = 0.0;
  for (const Ingredient* one : effects_of(form)) {
    if (numerical(one->name())) continue;
    names.insert(one->name());
    const auto known = forms_.find(one->name());
    if (known != forms_.end()) out -= std::log(std::max(1, known->second));
  }
  const auto standing = static_cast<int>(names.size());
  return out - log_choose(std::max(effects_, standing), standing);
}

ModelPrices model_prices(const Fitted& fitted) {
  const Model model = realised(fitted);
  std::map<std::string, int> forms;
  int effects = 0;
  for (const Effect* effect : catalogue()) {
    if (effect->group() == EffectGroup::numerical) continue;
    ++effects;
    std::set<std::string> kinds;
    for (const auto& one : effect->candidates(model, nullptr))
      kinds.insert(kind_of(one->variant()));
    forms[effect->name()] = static_cast<int>(kinds.size());
  }
  return ModelPrices(effects, std::move(forms));
}

ScoredModel scored_model(const Fitted& fitted, const ModelPrices& prices, const Evaluation* sums,
                         double to_the_limit) {
  ScoredModel out;
  out.words = effects_in_words(fitted.form);
  out.misfit = misfit(fitted);
  out.seen = seen_parts(fitted, sums);
  out.log_prior = prices.log_prior(fitted.form);
  out.chance = fitted.form.scene->limits->floor.chance;
  const Scaling scaling{fitted.form.parameters()};
  const VectorXd x = scaling.to_x(fitted.p);
  const size_t own = base_form(fitted.form.scene).ingredients.size();
  for (size_t i = 0; i < fitted.form.ingredients.size(); ++i)
    for (const Parameter& parameter : fitted.form.ingredients[i]->parameters()) {
      const auto at = static_cast<Eigen::Index>(out.columns.size());
      out.columns.push_back(column_of(*fitted.form.ingredients[i], parameter, x[at], i >= own));
    }
  const Eigen::Index m = x.size() + (sums ? 1 : 0);
  VectorXd dp_dx(m);
  dp_dx.head(x.size()) = scaling.dp_dx(fitted.p);
  if (sums) {  // u u^T: a share of the mesh's error, normal about none of it
    dp_dx[x.size()] = to_the_limit;
    out.columns.push_back({0.0, 1.0, false, false, false});
  }
  for (SeenPart& part : out.seen) {
    scale(dp_dx, part);
    // The fit ended where its photos leave least. That these weights would have it elsewhere is no
    // gain: with few cells that count, a field of many values could take all that is left.
    if (!part.held_out) part.s.head(x.size()).setZero();
  }
  return out;
}

ModelScore score(const ScoredModel& model, const ResidualNoise& noise) {
  auto fitted = in_noise(model.seen, noise, false), held_out = in_noise(model.seen, noise, true);
  hold(model.columns, fitted);
  hold(model.columns, held_out);
  std::vector<EffectiveSums> all = fitted;
  all.insert(all.end(), held_out.begin(), held_out.end());
  const ChainEvidence evidence = chain_evidence(fitted, held_out, prior_of(model, all));
  ModelScore out{evidence.fitted, evidence.held_out, model.log_prior, model.log_prior};
  for (const EffectiveSums& group : all)
    if (group.count > 0.0) out.ceiling -= 0.5 * chi2_quantile(model.chance, group.count);
  return out;
}

std::vector<double> posterior(const std::vector<double>& scores) {
  if (scores.empty()) return {};
  const double most = *std::max_element(scores.begin(), scores.end());
  std::vector<double> out;
  double sum = 0.0;
  for (const double one : scores) sum += out.emplace_back(std::exp(one - most));
  for (double& one : out) one /= sum;
  return out;
}

}  // namespace hookeye
