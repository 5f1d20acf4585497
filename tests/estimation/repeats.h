// Captures made over and over with other textures and noise: do the statistics hold?
#pragma once

#include <map>
#include <string>
#include <vector>

#include "estimation/search/discover.h"
#include "tests/estimation/small_capture.h"

namespace hookeye::test {

struct Repeat {
  double p_value = 1.0;  ///< of the largest evidence
  std::string first;     ///< effect of the largest evidence
  /// First effect that would be refitted, with the motion in px that would fall by as much; the
  /// mesh where it is not the truth's is none.
  std::string named;
  /// By effect: what it would take off sum (residual / noise)^2, as it is scored.
  std::map<std::string, double> fall;
  /// The true mu lies in the interval: that for noise, or, where the truth has another mesh, that
  /// which reaches for the mesh.
  bool covered = false;
  double over_deviation = 0.0;  ///< log(mu/true) over the standard error that the interval tells
};

/// Fits mu and diagnoses, as a user would. The true mu is SmallCapture's.
Repeat repeat(const SmallCapture& capture, const DiagnosisOptions& options = {});

/// Fits mu alone, on the truth's own mesh: what the interval tells, and nothing of effects.
Repeat repeat_fit(const SmallCapture& capture);

struct Searched {
  std::string wrong;  ///< names that a search found, but for the mesh; empty: none
  std::string verdict;
  double mu = 0.0, low = 0.0, high = 0.0;  ///< of the last model
  bool covered = false;
};

/// discover() on a capture that hides nothing.
Searched search(const SmallCapture& capture);

/// Forces at random all over the body, other ones in every example: it explains nothing that is.
class Placebo final : public Effect {
 public:
  explicit Placebo(unsigned seed) : seed_(seed) {}
  std::string name() const override { return "placebo"; }
  EffectGroup group() const override { return EffectGroup::loads; }
  std::string title() const override { return "nothing that is"; }
  std::string manual() const override { return title(); }
  std::vector<std::shared_ptr<const Ingredient>> candidates(const Model& model,
                                                            std::string* why_not) const override;
  std::string sentence(const Model&, const Ingredient&, const VectorXd&) const override {
    return title();
  }

 private:
  unsigned seed_;
};

/// Largest excess of the empirical distribution of p over the uniform one; p = 1 may be as frequent
/// as it likes (evidence stops at zero).
double excess_over_uniform(std::vector<double> p);
/// What that excess passes in 5 % of cases (one-sided Kolmogorov-Smirnov).
double excess_95(int n);
/// The excess, or what the empirical distribution falls short of the uniform one, if that is more
/// (two-sided; p = 1 as above), and its 5 % point.
double distance_from_uniform(std::vector<double> p);
double distance_95(int n);
/// Largest count that a share of 5 % gives in 95 % of cases.
int count_95(int n);

}  // namespace hookeye::test
