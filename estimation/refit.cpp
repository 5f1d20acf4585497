#include "estimation/refit.h"

#include <algorithm>

namespace hookeye {

namespace {

constexpr size_t kSecondRound = 4;

bool cancelled(const NumericalFailure& failure) { return failure.reason == "cancelled"; }

/// The model with one effect more, and where to start it.
struct Extension {
  ModelForm form;

  Extension(const Fitted& current, const EffectScore& score)
      : form(current.form), p_(current.p), values_(score.values) {
    const Model model = current.form.realise(current.p);
    auto ingredient = find_effect(score.effect)->refit_form(model, score.best, values_);
    parameters_ = ingredient->parameters();
    from_ = values_;
    // the refit form may have other parameters than the scored one: then its own start counts
    if (ingredient == score.best)
      for (int i = 0; i < values_.size(); ++i) from_[i] = parameters_[i].value;
    form.ingredients.push_back(std::move(ingredient));
  }
  VectorXd start(double share) const {
    VectorXd out(p_.size() + values_.size());
    out.head(p_.size()) = p_;
    for (int i = 0; i < values_.size(); ++i)
      out[p_.size() + i] = std::clamp(from_[i] + share * (values_[i] - from_[i]),
                                      parameters_[i].low, parameters_[i].high);
    return out;
  }

 private:
  VectorXd p_, values_, from_;
  std::vector<Parameter> parameters_;
};

/// The linear step is a direction more than a length: where even half of it has no equilibrium or
/// is worse than the null, `run(start)` starts from the null.
template <class Run>
auto from_shares(const Extension& extension, const FitOptions& options, const Run& run) {
  auto result = run(extension.start(1.0));
  for (double share : {0.3, 0.0}) {
    const auto* failure = std::get_if<NumericalFailure>(&result);
    if (!failure || cancelled(*failure) || (options.cancel && options.cancel->load())) break;
    result = run(extension.start(share));
  }
  return result;
}

FitOptions warm(const FitOptions& options) {
  FitOptions out = options;
  out.coarse_to_fine = false;
  return out;
}

}  // namespace

std::variant<Fitted, NumericalFailure> add_effect(Workspace& workspace, const Fitted& current,
                                                  const EffectScore& score,
                                                  const FitOptions& options) {
  const Extension extension(current, score);
  return from_shares(extension, options, [&](const VectorXd& start) {
    return fit(workspace, extension.form, start, warm(options));
  });
}

std::variant<std::vector<Racer>, NumericalFailure> race(
    Workspace& workspace, const Fitted& current, const Diagnosis& diagnosis,
    const FitOptions& options, const std::function<void(const Racer&)>& tried) {
  std::vector<Racer> racers;
  const auto huber = trial_huber(workspace, current.form, current.p, options);
  if (auto* failure = std::get_if<NumericalFailure>(&huber)) return *failure;
  auto step = [&](const ModelForm& form, const VectorXd& start) {
    return try_step(workspace, form, start, std::get<double>(huber), options);
  };
  for (const EffectScore& score : diagnosis.effects) {
    if (!nameable(score, diagnosis)) continue;
    const Extension extension(current, score);
    auto result = from_shares(extension, options,
                              [&](const VectorXd& start) { return step(extension.form, start); });
    if (auto* failure = std::get_if<NumericalFailure>(&result)) {
      if (cancelled(*failure)) return *failure;
      continue;
    }
    racers.push_back({score.effect, extension.form, std::get<Trial>(std::move(result))});
    if (tried) tried(racers.back());
  }
  auto sort = [&] {
    std::stable_sort(racers.begin(), racers.end(),
                     [](const Racer& a, const Racer& b) { return a.chi() < b.chi(); });
  };
  sort();
  for (size_t i = 0; racers.size() > 1 && i < std::min(kSecondRound, racers.size()); ++i) {
    auto result = step(racers[i].form, racers[i].trial.p);
    if (auto* failure = std::get_if<NumericalFailure>(&result)) {
      if (cancelled(*failure)) return *failure;
      continue;
    }
    if (std::get<Trial>(result).chi_fit > racers[i].trial.chi_fit) continue;  // a step too far
    racers[i].trial = std::get<Trial>(std::move(result));
    if (tried) tried(racers[i]);
  }
  sort();
  return racers;
}

std::variant<Fitted, NumericalFailure> refit(Workspace& workspace, const Racer& racer,
                                             const FitOptions& options) {
  return fit(workspace, racer.form, racer.trial.p, warm(options));
}

}  // namespace hookeye
