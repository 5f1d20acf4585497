// Do the statistics hold? Captures that hide nothing, over and over with other textures and noise:
// p-values must be uniform (or larger), false alarms at most 5 %, intervals must cover.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "estimation/discover.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

struct Repeat {
  double p_value = 1.0;  ///< of the largest evidence
  std::string named;     ///< an effect that would be refitted; empty: none
  bool covered = false;
  double over_deviation = 0.0;  ///< (mu - true)/standard error that the interval tells
};

Repeat once(unsigned seed, bool same_renderer) {
  const double truth = 0.02;
  const test::SmallScene small({.told = "0.0215", .same_renderer = same_renderer, .seed = seed});
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  const auto fitted = std::get<Fitted>(fit(workspace, form, form.initial()));
  const auto diagnosis = std::get<Diagnosis>(diagnose(workspace, fitted));
  Repeat out;
  out.covered = fitted.low[0] <= truth && truth <= fitted.high[0];
  out.over_deviation =
      std::log(fitted.p[0] / truth) / (std::log(fitted.high[0] / fitted.low[0]) / (2.0 * 1.959964));
  for (const auto& effect : diagnosis.effects) {
    out.p_value = std::min(out.p_value, effect.p_value);
    if (out.named.empty() && nameable(effect, diagnosis))
      out.named = fmt::format("{} (as {:.4f} px would)", effect.effect,
                              std::sqrt(effect.fall / diagnosis.floor.per_px2));
  }
  return out;
}

/// Largest excess of the empirical distribution of p over the uniform one, and the point that
/// excess passes in 5 % of cases (one-sided Kolmogorov-Smirnov, n > 35).
double excess(std::vector<double> p) {
  std::sort(p.begin(), p.end());
  double most = 0.0;
  for (size_t i = 0; i < p.size(); ++i)
    if (p[i] < 1.0) most = std::max(most, (i + 1.0) / static_cast<double>(p.size()) - p[i]);
  return most;
}

/// Largest count that a share of 5 % gives in 95 % of cases.
int binomial_95(int n) {
  double sum = 0.0, term = std::pow(0.95, n);
  for (int k = 0; k <= n; ++k) {
    sum += term;
    if (sum >= 0.95) return k;
    term *= (n - k) / (k + 1.0) * 0.05 / 0.95;
  }
  return n;
}

int main_of(int argc, char** argv) {
  int repeats = 200;
  bool other_renderer = false;
  unsigned first = 1;
  CLI::App app("Statistics of captures that hide nothing");
  app.add_option("-n,--repeats", repeats, "Captures");
  app.add_option("--first-seed", first, "Seed of the first");
  app.add_flag("--other-renderer", other_renderer,
               "Photos with other rays than the fit's: noise is not all that is left");
  CLI11_PARSE(app, argc, argv);
  std::vector<double> p;
  int named = 0, missed = 0;
  double spread = 0.0;
  for (int i = 0; i < repeats; ++i) {
    const Repeat one = once(first + i, !other_renderer);
    p.push_back(one.p_value);
    named += !one.named.empty();
    missed += !one.covered;
    spread += one.over_deviation * one.over_deviation;
    fmt::print("seed {}: p {:.4f}, mu {:+.2f} standard errors off{}{}\n", first + i, one.p_value,
               one.over_deviation, one.covered ? "" : ", interval misses",
               one.named.empty() ? "" : ", false alarm: " + one.named);
    std::fflush(stdout);
  }
  const int most = binomial_95(repeats);
  const double ks = excess(p), limit = 1.2239 / std::sqrt(repeats);
  fmt::print(
      "{} captures\n"
      "p-values: largest excess over uniform {:.3f} (5 % point {:.3f})\n"
      "false alarms: {} (5 % of them, at most {})\n"
      "intervals that miss: {} (5 % of them, at most {}); rms of (mu - true)/standard error "
      "{:.2f}\n",
      repeats, ks, limit, named, most, missed, most, std::sqrt(spread / repeats));
  return ks <= limit && named <= most && missed <= most ? 0 : 1;
}

}  // namespace
}  // namespace hookeye

int main(int argc, char** argv) { return hookeye::main_of(argc, argv); }
