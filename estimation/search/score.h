// The score of a model, a function of it alone: log p(fitted | M) + log p(held out | fitted, M) +
// log prior(M). It stands in the shadow: it is written beside refit_score and decides nothing.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "estimation/diagnosis/residual_noise.h"
#include "estimation/fit/chain_evidence.h"

namespace hookeye {

/// log prior of a model: k of the n effects of the catalogue stand (extended BIC: Chen and Chen
/// 2008), each in one of its forms. The mesh is no hypothesis about the body: it costs nothing.
class ModelPrices {
 public:
  /// `forms`: by effect, how many forms it is tested in; those of another number are different
  /// places or directions, which their own numbers pay for.
  ModelPrices(int effects, std::map<std::string, int> forms)
      : effects_(effects), forms_(std::move(forms)) {}
  double log_prior(const ModelForm& form) const;

 private:
  int effects_;
  std::map<std::string, int> forms_;
};
/// Of the catalogue beside the fitted model.
ModelPrices model_prices(const Fitted& fitted);

/// "gravity, creep as 'levels off'": what stands beyond the capture's own model; "": nothing.
std::string effects_in_words(const ModelForm& form);

/// All that a score needs of a fitted model.
struct ScoredModel {
  std::string words;  ///< effects_in_words()
  double misfit = 0.0;
  std::vector<SeenPart> seen;  ///< in the units of a fit (Scaling)
  double log_prior = 0.0;      ///< of its effects and forms
  /// Of every column: a prior of its size; without one, and `known_by` numbers that show it, that
  /// of one of those (unit information: Kass and Wasserman 1995).
  struct Column {
    double mean = 0.0, deviation = 0.0;  ///< less the fitted value; 0: unit information
    bool one_sided = false, at_bound = false, sensors_alone = false;
  };
  std::vector<Column> columns;
  double chance = 0.001;  ///< FloorLimits::chance
};
/// `sums`: as seen_parts() has it, its last column what a finer mesh changes, `to_the_limit` times
/// of which an infinitely fine one would.
ScoredModel scored_model(const Fitted& fitted, const ModelPrices& prices,
                         const Evaluation* sums = nullptr, double to_the_limit = 1.0);

/// Terms of a score, in nats; but for a constant that is the data's.
struct ModelScore {
  double fitted = 0.0, held_out = 0.0, prior = 0.0;
  /// What no fit of the model exceeds: if all residuals were noise (as little as in one of a
  /// thousand captures, FloorLimits::chance), less the price of its effects and forms.
  double ceiling = 0.0;
  double total() const { return fitted + held_out + prior; }
};
ModelScore score(const ScoredModel& model, const ResidualNoise& noise);

/// Probability of each among them: their scores' softmax.
std::vector<double> posterior(const std::vector<double>& scores);

}  // namespace hookeye
