#include "estimation/synth/synth_truth.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include "capture_io/yaml_section.h"
#include "estimation/effects/catalogue.h"
#include "estimation/fit/lost_ellipticity.h"
#include "estimation/model/declaration.h"

namespace hookeye::detail {

TruthSolver::TruthSolver(std::shared_ptr<const Scene> scene, const std::atomic<bool>* cancel)
    : scene_(std::move(scene)), cancel_(cancel) {
  for (size_t e = 0; e < scene_->capture.examples.size(); ++e)
    solvers_.emplace_back(scene_->mesh());
}

Result<std::vector<TruthSolver::State>> TruthSolver::solve(const Model& model) {
  EquilibriumOptions options;
  // Those that stand take some ten to forty; a drawn load under which the body snaps through can be
  // sought for thousands, and is drawn smaller when it has none.
  options.most_iterations = 300;
  if (cancel_) options.cancelled = [this] { return cancel_->load(); };
  std::vector<State> states(solvers_.size());
  std::optional<NumericalFailure> failed;
  std::mutex mutex;
  tbb::parallel_for(size_t{0}, solvers_.size(), [&](size_t e) {
    const ExampleSpec& example = scene_->capture.examples[e];
    auto solved =
        solvers_[e].solve(model.energy_of(static_cast<int>(e)), model.examples[e].loading, options);
    if (!solved) {
      const std::lock_guard lock(mutex);
      failed = std::move(solved.error());
      failed->example = example.name;
      return;
    }
    const auto& equilibrium = *solved;
    states[e].q = equilibrium.q;
    for (const MeasuredSpec& spec : example.measured) {
      const Region& region = scene_->body->regions.at(spec.region);
      if (spec.kind == MeasuredSpec::Kind::force_on)
        states[e].grip.force = support_force(equilibrium, region) + model.examples[e].force_offset;
      else
        states[e].grip.moment = support_moment(equilibrium, region, spec.direction);
    }
  });
  if (failed) return no_result(*std::move(failed));
  return states;
}

namespace {

/// What may be put in: the variant that the recipe names; the only one; or, where values are drawn
/// too, all of them in drawn order.
std::vector<std::shared_ptr<const Ingredient>> choices(const HiddenRecipe& hidden,
                                                       const Effect& effect, const Model& model,
                                                       std::mt19937_64& random) {
  if (auto found = effect.candidate(model, hidden.variant)) return {found};
  std::string why;
  auto all = effect.candidates(model, &why);
  if (all.empty())
    throw InputError(hidden.place,
                     fmt::format("`{}` cannot be hidden in this capture", hidden.effect), why);
  if (hidden.variant.empty() && (all.size() == 1 || hidden.drawn)) {
    std::shuffle(all.begin(), all.end(), random);
    return all;
  }
  std::vector<std::string> known;
  int ways = 0;
  for (const DeclaredForm& form : declare(effect, model).forms) {
    ways += form.ways;
    if (known.size() < 12) known.push_back(fmt::format("\"{}\"", form.variant));
  }
  const std::string right =
      fmt::format("write `variant:` with one of the {} here: {}{}; see `hookeye effects {}`", ways,
                  fmt::join(known, ", "), known.size() < static_cast<size_t>(ways) ? " ..." : "",
                  hidden.effect);
  if (hidden.variant.empty())
    throw InputError(hidden.place,
                     fmt::format("`{}` can be present in several ways", hidden.effect), right);
  throw InputError(hidden.variant_place,
                   fmt::format("`{}` has no variant `{}` here", hidden.effect, hidden.variant),
                   right);
}

void check_range(const Parameter& parameter, double value, const Place& place,
                 const std::string& wrong) {
  if (value >= parameter.low && value <= parameter.high) return;
  throw InputError(place,
                   fmt::format("{}: {} = {:.4g} is out of range", wrong, parameter.name, value),
                   fmt::format("between {:.4g} and {:.4g}", parameter.low, parameter.high));
}

VectorXd told_values(const HiddenRecipe& hidden, const std::vector<Parameter>& parameters) {
  std::vector<std::string> known;
  VectorXd values(parameters.size());
  for (size_t i = 0; i < parameters.size(); ++i) {
    values[i] = parameters[i].value;
    known.push_back(parameters[i].name);
    const auto given = hidden.values.find(parameters[i].name);
    if (given == hidden.values.end()) continue;
    values[i] = given->second.number;
    check_range(parameters[i], values[i], given->second.place, "the value");
  }
  for (const auto& [name, value] : hidden.values)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InputError(value.place, fmt::format("`{}` has no parameter `{}`", hidden.effect, name),
                       suggest(name, known));
  return values;
}

/// Each parameter one to two typical changes off its null, to a side that its bounds allow.
VectorXd drawn_values(const std::vector<Parameter>& parameters, std::mt19937_64& random) {
  VectorXd values(parameters.size());
  for (size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& p = parameters[i];
    const double size = uniform(random, 1.0, 2.0) * p.typical;
    const bool up = random() % 2 == 0;
    values[i] = p.value + (up ? size : -size);
    if (values[i] > p.high || values[i] < p.low) values[i] = p.value + (up ? -size : size);
    values[i] = std::clamp(values[i], p.low, p.high);
  }
  return values;
}

/// Largest factor on values - null that stays within 90 % of the way to every bound.
double largest_factor(const std::vector<Parameter>& parameters, const VectorXd& null,
                      const VectorXd& values) {
  double factor = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < parameters.size(); ++i) {
    const double step = values[i] - null[i];
    const double bound = step > 0.0 ? parameters[i].high : parameters[i].low;
    if (step != 0.0) factor = std::min(factor, 0.9 * (bound - null[i]) / step);
  }
  return factor;
}

/// Root mean square of the motion of the surface's points in the fitted pictures.
double rms_px(const Scene& scene, const Model& a, const std::vector<TruthSolver::State>& in_a,
              const Model& b, const std::vector<TruthSolver::State>& in_b) {
  const RenderSurface& surface = scene.body->surface;
  double sum = 0.0, count = 0.0;
  for (size_t e = 0; e < in_a.size(); ++e) {
    if (scene.capture.examples[e].validate) continue;
    const Matrix3Xd xa = surface.deformed(scene.body->mesh, in_a[e].q);
    const Matrix3Xd xb = surface.deformed(scene.body->mesh, in_b[e].q);
    for (size_t k = 0; k < a.examples[e].photos.size(); ++k)
      for (Eigen::Index v = 0; v < xa.cols(); ++v) {
        sum += (a.examples[e].photos[k].camera.project(xa.col(v)) -
                b.examples[e].photos[k].camera.project(xb.col(v)))
                   .squaredNorm();
        count += 1.0;
      }
  }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

/// The truth found so far with one ingredient more.
struct Addition {
  ModelForm form;
  VectorXd p;
  Model model;
  std::vector<TruthSolver::State> states;
  double rms_px = 0.0;  ///< by which it moves the pictures
  /// Ellipticity is lost where it was not before: the same loads have several equilibria, and a fit
  /// may rightly find another one than the pictures show.
  bool unstable = false;
};

int elements_lost(const Model& model, const std::vector<TruthSolver::State>& states) {
  int lost = 0;
  for (size_t e = 0; e < states.size(); ++e)
    lost +=
        lost_ellipticity(model.scene->body->mesh, model.energy_of(static_cast<int>(e)), states[e].q)
            .elements;
  return lost;
}

Result<Addition> add_to(const Truth& truth, TruthSolver& solver,
                        const std::shared_ptr<const Ingredient>& ingredient,
                        const VectorXd& values) {
  Addition out{truth.form, VectorXd(truth.p.size() + values.size()), {}, {}, 0.0, false};
  out.form.ingredients.push_back(ingredient);
  out.p << truth.p, values;
  out.model = out.form.realise(out.p);
  auto solved = solver.solve(out.model);
  if (!solved) return failure_of(solved);
  out.states = *std::move(solved);
  out.rms_px = rms_px(*out.model.scene, truth.model, truth.states, out.model, out.states);
  out.unstable = ingredient->touches().energy &&
                 elements_lost(out.model, out.states) > elements_lost(truth.model, truth.states);
  return out;
}

/// Nothing moves below this.
constexpr double kStill = 1e-9;  // px

/// Whether an addition leaves the equilibria of all examples as they were, but for rounding.
bool leaves_all_still(const Truth& truth, const Addition& addition) {
  const Matrix3Xd& X = truth.model.scene->body->mesh.X;
  const double rounding = 1e-9 * (X.colwise() - X.rowwise().mean()).cwiseAbs().maxCoeff();
  for (size_t e = 0; e < truth.states.size(); ++e)
    if ((addition.states[e].q - truth.states[e].q).cwiseAbs().maxCoeff() > rounding) return false;
  return true;
}

/// Told values that grow with the size of the pictures' motion: those whose null alone undoes the
/// effect say how strong it is, and the others where. Where there are none, all grow together.
std::vector<char> strengths(const Truth& truth, TruthSolver& solver,
                            const std::shared_ptr<const Ingredient>& ingredient,
                            const VectorXd& null, const VectorXd& told) {
  std::vector<char> grows(static_cast<size_t>(told.size()), 0);
  for (Eigen::Index i = 0; i < told.size(); ++i) {
    if (told[i] == null[i]) continue;
    VectorXd without = told;
    without[i] = null[i];
    const auto added = add_to(truth, solver, ingredient, without);
    grows[i] = added && !(added->rms_px > kStill);
  }
  if (std::find(grows.begin(), grows.end(), 1) == grows.end()) grows.assign(grows.size(), 1);
  return grows;
}

/// Finds the factor on an effect's values that moves the pictures by as much as wanted.
class Scaling {
 public:
  /// `factor` moves by `rms_px`; the one to try next. In proportion, or, between one that moves
  /// less and one that moves more, by the power law through both: a body that softens gives by 1/(1
  /// - d), and in proportion one would go to and fro about the right d.
  double next(double factor, double rms_px, double wanted) {
    (rms_px < wanted ? below_ : above_) = {factor, rms_px};
    if (!(below_.factor > 0.0 && above_.factor > below_.factor)) return factor * wanted / rms_px;
    const double power =
        std::log(above_.rms_px / below_.rms_px) / std::log(above_.factor / below_.factor);
    return below_.factor * std::pow(wanted / below_.rms_px, 1.0 / power);
  }

  /// Sixteen times the values would not move the pictures twice as far, seen from what was tried
  /// last: fibres that have stopped what they can stop.
  bool saturated(double factor, double rms_px) const {
    return below_.factor > 0.0 && factor > below_.factor &&
           std::log(rms_px / below_.rms_px) < 0.25 * std::log(factor / below_.factor);
  }
  double last_below() const { return below_.factor; }

 private:
  struct Tried {
    double factor = 0.0, rms_px = 0.0;
  };
  Tried below_, above_;
};

/// Scales the drawn or told values until the pictures move by what the recipe asks for, and adds
/// them to the truth. False: drawn values of an effect on forces or material that move nothing, or
/// less than `least` of what was asked for (a plane that no fitted example reaches, or with a
/// corner alone).
Result<bool> put_in(const HiddenRecipe& hidden, const std::shared_ptr<const Ingredient>& ingredient,
                    double least, std::mt19937_64& random, TruthSolver& solver, Truth& truth) {
  const auto parameters = ingredient->parameters();
  const VectorXd told =
      hidden.drawn ? drawn_values(parameters, random) : told_values(hidden, parameters);
  VectorXd null(parameters.size());
  for (size_t i = 0; i < parameters.size(); ++i) null[i] = parameters[i].value;
  double largest = hidden.drawn ? largest_factor(parameters, null, told) : 1e300;
  double factor = std::min(hidden.times, largest);
  Scaling scaling;
  const Touches touches = ingredient->touches();
  const int most = hidden.rms_px ? 8 : 1;
  std::vector<char> grows(parameters.size(), 1);
  if (hidden.rms_px && !hidden.drawn && parameters.size() > 1)
    grows = strengths(truth, solver, ingredient, null, told);
  for (int i = 0; i < most; ++i) {
    VectorXd values = told;
    for (size_t k = 0; k < parameters.size(); ++k)
      if (grows[k]) values[k] = null[k] + factor * (told[k] - null[k]);
    for (size_t k = 0; k < parameters.size(); ++k)
      check_range(parameters[k], values[k], hidden.values_place,
                  fmt::format("{} px cannot be reached", hidden.rms_px.value_or(0.0)));
    auto added = add_to(truth, solver, ingredient, values);
    if (!added && (!hidden.drawn || i + 1 == most)) return failure_of(added);
    if (!added || (hidden.drawn && i + 1 < most && added->unstable)) {
      largest = 0.7 * factor;  // drawn too large for an equilibrium, or for one alone
      factor *= 0.5;
      continue;
    }
    Addition& addition = *added;
    const double wanted = hidden.rms_px.value_or(0.0);
    const bool still = !(addition.rms_px > kStill);  // light, exposure: there is nothing to scale
    if (still && hidden.drawn && (touches.loading || touches.energy)) return false;
    if (still && (touches.loading || touches.energy) && leaves_all_still(truth, addition))
      throw InputError(hidden.values_place,
                       fmt::format("`{}` changes nothing with these values", hidden.effect),
                       "values off their nulls, and a place within the body");
    const bool reached = hidden.rms_px && std::abs(addition.rms_px / wanted - 1.0) < 0.03;
    const bool at_bound = factor == largest && addition.rms_px < wanted;
    if (hidden.drawn && at_bound && addition.rms_px < least * wanted) return false;
    if (i + 1 == most || reached || at_bound || (still && hidden.drawn)) {
      PutIn put{find_effect(hidden.effect), ingredient, values, addition.rms_px, ""};
      put.sentence = put.effect->sentence(truth.model, *ingredient, values);
      truth.form = std::move(addition.form);
      truth.p = std::move(addition.p);
      truth.model = std::move(addition.model);
      truth.states = std::move(addition.states);
      truth.hidden.push_back(std::move(put));
      return true;
    }
    if (still) return false;
    if (hidden.drawn && addition.rms_px < wanted && scaling.saturated(factor, addition.rms_px)) {
      factor = largest = scaling.last_below();
      continue;
    }
    factor = std::min(scaling.next(factor, addition.rms_px, wanted), largest);
  }
  return false;
}

/// Adds one hidden effect to the truth found so far.
Result<void> hide(const HiddenRecipe& hidden, unsigned seed, TruthSolver& solver, Truth& truth) {
  auto random = random_of(seed, "hidden " + hidden.effect);
  const auto all = choices(hidden, *find_effect(hidden.effect), truth.model, random);
  for (const double least : {0.5, 0.0})
    for (const auto& ingredient : all) {
      auto put = put_in(hidden, ingredient, least, random, solver, truth);
      if (!put) return failure_of(put);
      if (*put) return {};
    }
  throw InputError(hidden.place, fmt::format("`{}` moves nothing in these pictures", hidden.effect),
                   "leave rms_px out and give the values as they are");
}

}  // namespace

Result<Truth> find_truth(const Recipe& recipe, std::shared_ptr<const Scene> scene,
                         const std::atomic<bool>* cancel) {
  Truth truth;
  truth.form = base_form(scene);
  truth.p = truth.form.initial();
  truth.model = truth.form.realise(truth.p);
  TruthSolver solver(scene, cancel);
  auto solved = solver.solve(truth.model);
  if (!solved) return failure_of(solved);
  truth.states = *std::move(solved);
  for (const HiddenRecipe& hidden : recipe.hidden)
    if (auto done = hide(hidden, recipe.seed, solver, truth); !done) return failure_of(done);
  truth.elements_lost = elements_lost(truth.model, truth.states);
  return truth;
}

}  // namespace hookeye::detail
