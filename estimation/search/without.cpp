#include "estimation/search/without.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/distributions.h"
#include "estimation/fit/ahead.h"
#include "estimation/fit/at_floor.h"
#include "estimation/search/extension.h"
#include "estimation/search/refit_score.h"
#include "estimation/search/swaps.h"

namespace hookeye {

std::optional<Fitted> fit_without(Workspace& workspace, const Fitted& fitted, size_t i,
                                  const FitOptions& options) {
  const auto [form, stands] = parted_from(fitted, i);
  VectorXd told = stands;
  const Eigen::Index own =
      std::min(fitted.form.layout()[i].first, base_form(form.scene).initial().size());
  told.head(own) = form.initial().head(own);
  double least = std::numeric_limits<double>::infinity();
  VectorXd start = stands;
  for (const VectorXd& p : {stands, told}) {
    const auto there = assess(workspace, form, p, options);
    if (there && misfit(*there) < least) least = misfit(*there), start = p;
  }
  FitOptions from_there = options;
  from_there.coarse_to_fine = least > form.scene->limits->search.coarse_again * misfit(fitted);
  auto result = fit(workspace, form, start, from_there);
  if (result) return *std::move(result);
  return {};
}

namespace {

/// Some parameter from `offset` on stands 15 standard errors off its null: 100 in log-likelihood,
/// with which no effect is idle.
bool stands(const Fitted& fitted, Eigen::Index offset, const std::vector<Parameter>& own) {
  for (size_t k = 0; k < own.size(); ++k) {
    const auto i = offset + static_cast<Eigen::Index>(k);
    const double deviation = (fitted.high[i] - fitted.low[i]) / (2.0 * kNormal95);
    if (std::abs(fitted.p[i] - own[k].value) >
        fitted.form.scene->limits->search.stands_deviations * deviation)
      return true;
  }
  return false;
}

/// The model without each of these, ahead.
void fit_without_ahead(Workspace& workspace, const Fitted& fitted, const std::vector<size_t>& each,
                       const FitOptions& options) {
  std::vector<AheadTask> tasks;
  const FitOptions own = untold(options);
  for (const size_t i : each)
    tasks.push_back(ahead_task(fmt::format("without {}", i), fitted.form, fitted.p,
                               [&, own, i] { (void)fit_without(workspace, fitted, i, own); }));
  work_ahead(workspace, options.cancel, tasks);
}

}  // namespace

std::optional<Refit> backward(Workspace& workspace, const Fitted& current, const Floor& floor,
                              size_t first_effect, const DiscoverOptions& options) {
  const Yardstick yardstick{&current, &floor, measured_noise2(current)};
  const double full = refit_score(current, yardstick);
  std::vector<size_t> each;
  for (size_t i = first_effect; i + 1 < current.form.ingredients.size(); ++i) {
    const Ingredient& one = *current.form.ingredients[i];
    if (!remeshed_by(one) && !stands(current, current.form.layout()[i].first, one.parameters()))
      each.push_back(i);
  }
  const Workspace::Place here = workspace.place();
  fit_without_ahead(workspace, current, each, options.fit);
  for (const size_t i : each) {
    const Ingredient& one = *current.form.ingredients[i];
    workspace.start_from(here);
    auto lighter = fit_without(workspace, current, i, options.fit);
    if (!lighter) continue;
    const double score = refit_score(*lighter, yardstick), tie = floor.limits->diagnosis.tie;
    if (tell(options.fit.decided, {Asked::dropped,
                                   one.name(),
                                   score > full - tie,
                                   {score - full, -tie, "diagnosis.tie"},
                                   "penalised log likelihood without it over that with it"}))
      return Refit{one.name(), std::move(*lighter), score};
  }
  return {};
}

bool holds_null(const Fitted& fitted, size_t i) {
  const Ingredient& ingredient = *fitted.form.ingredients[i];
  if (remeshed_by(ingredient)) return false;
  const auto own = ingredient.parameters();
  const Eigen::Index first = fitted.form.layout()[i].first;
  for (size_t k = 0; k < own.size(); ++k) {
    const auto at = first + static_cast<Eigen::Index>(k);
    if (fitted.low[at] > own[k].value || own[k].value > fitted.high[at]) return false;
  }
  return true;
}

std::optional<Refit> drop_unsupported(Workspace& workspace, const Fitted& fitted,
                                      const Floor& floor, size_t first_effect,
                                      const DiscoverOptions& options) {
  const auto& all = fitted.form.ingredients;
  if (all.size() < first_effect + 2 || !at_floor(fitted, floor)) return {};
  std::vector<size_t> each;
  for (size_t i = first_effect; i < all.size(); ++i)
    if (holds_null(fitted, i)) each.push_back(i);
  const Workspace::Place here = workspace.place();
  fit_without_ahead(workspace, fitted, each, options.fit);
  for (const size_t i : each) {
    workspace.start_from(here);
    auto lighter = fit_without(workspace, fitted, i, options.fit);
    if (lighter && tell(options.fit.decided,
                        {Asked::dropped,
                         all[i]->name(),
                         at_floor(*lighter, floor),
                         {std::max(lighter->evaluation.chi(false), lighter->evaluation.chi(true)),
                          floor.limits->floor.at * floor.chi, "floor.at"},
                         "its intervals hold its null; the normalised residual without it"}))
      return Refit{all[i]->name(), std::move(*lighter), 0.0};
  }
  return {};
}

bool equals_after_swap(Workspace& workspace, const Fitted& rival, const Fitted& winner,
                       const std::string& dropped, const Floor& floor, const FitOptions& options) {
  const Yardstick yardstick{&winner, &floor, measured_noise2(winner)};
  const double enough = refit_score(winner, yardstick) - floor.limits->diagnosis.tie;
  if (refit_score(rival, yardstick) > enough) return true;
  for (size_t i = 0; i < rival.form.ingredients.size(); ++i)
    if (rival.form.ingredients[i]->name() == dropped) {
      const auto lighter = fit_without(workspace, rival, i, options);
      return lighter && refit_score(*lighter, yardstick) > enough;
    }
  return false;
}

}  // namespace hookeye
