// Do the statistics hold? Captures that hide nothing, over and over with other textures and noise:
// p-values must be uniform, false alarms at most 5 %, intervals must cover, and a
// placebo is no better off than the rest. With --hidden, captures that hide gravity: the placebo
// must never come first. With --power, effects of falling size: how often do they lead?
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "estimation/effects/catalogue.h"
#include "tests/estimation/repeats.h"

namespace hookeye {
namespace {

struct Options {
  int repeats = 200;
  unsigned first = 1;
  bool other_renderer = false, other_mesh = false;
  std::string hidden;
};

test::SmallCapture capture_of(const Options& options, unsigned seed) {
  test::SmallCapture out;
  out.hidden = options.hidden;
  out.truth_mesh = options.other_mesh ? "0.6" : "1";
  out.same_renderer = !options.other_renderer;
  out.seed = seed;
  return out;
}

struct Counts {
  std::vector<double> p;
  int named = 0, missed = 0, placebo = 0;
  double spread = 0.0;
};

Counts count(const Options& options) {
  Counts out;
  for (int i = 0; i < options.repeats; ++i) {
    const unsigned seed = options.first + i;
    const test::Placebo placebo(seed);
    DiagnosisOptions diagnosis;
    diagnosis.also = {&placebo};
    test::SmallCapture capture = capture_of(options, seed);
    capture.told = "0.0215";
    const test::Repeat one = test::repeat(capture, diagnosis);
    out.p.push_back(one.p_value);
    out.named += !one.named.empty();
    out.missed += !one.covered;
    out.placebo += one.named.rfind("placebo", 0) == 0;
    out.spread += one.over_deviation * one.over_deviation;
    fmt::print("seed {}: p {:.4f}, mu {:+.2f} standard errors off{}{}\n", seed, one.p_value,
               one.over_deviation, one.covered ? "" : ", interval misses",
               one.named.empty() ? "" : ", named: " + one.named);
    std::fflush(stdout);
  }
  return out;
}

/// Share of captures in which `effect` leads the ranking of what stands out, over its size; before
/// the race and the refits of discover. What moves nothing (light, exposure) falls from a third of
/// a typical change.
void power(Options options, const std::string& effect) {
  for (const double px : {0.3, 0.1, 0.05, 0.02, 0.01, 0.005}) {
    options.hidden =
        fmt::format("hidden:\n  - {{effect: {}, rms_px: {:g}, times: {:g}}}\n", effect, px, px);
    int named = 0, placebo = 0;
    double fall = 0.0;
    for (int i = 0; i < options.repeats; ++i) {
      const unsigned seed = options.first + i;
      const test::Placebo rival(seed);
      DiagnosisOptions diagnosis;
      diagnosis.also = {&rival};
      test::Repeat one = test::repeat(capture_of(options, seed), diagnosis);
      named += one.named.rfind(effect + " ", 0) == 0;
      placebo += one.named.rfind("placebo", 0) == 0;
      fall += one.fall[effect] / options.repeats;
    }
    // sqrt of the fall: what the effect changes in a pixel, over its noise (rms)
    fmt::print("  {:<30}{:<6g}  {:<10.2f}  {:.2f}   {:.2f}\n", effect, px,
               std::sqrt(std::max(0.0, fall)), static_cast<double>(named) / options.repeats,
               static_cast<double>(placebo) / options.repeats);
    std::fflush(stdout);
  }
}

int powers(const Options& options, std::vector<std::string> effects) {
  if (effects == std::vector<std::string>{"all"}) {
    effects.clear();
    for (const Effect* effect : catalogue())
      if (effect->group() != EffectGroup::numerical) effects.push_back(effect->name());
  }
  fmt::print("  {:<30}rms px  over noise  first  placebo\n", "hidden");
  for (const std::string& effect : effects) power(options, effect);
  return 0;
}

/// The whole search where nothing is hidden: names other than the mesh's, and whether the last
/// model's interval holds the modulus.
int searches(const Options& options) {
  int wrong = 0, missed = 0;
  for (int i = 0; i < options.repeats; ++i) {
    test::SmallCapture capture = capture_of(options, options.first + i);
    capture.told = "0.0215";
    const test::Searched one = test::search(capture);
    wrong += !one.wrong.empty();
    missed += !one.covered;
    fmt::print("seed {}: {}, mu {:.6f} in {:.6f} .. {:.6f}{}{}\n", capture.seed, one.verdict,
               one.mu, one.low, one.high, one.covered ? "" : ", interval misses",
               one.wrong.empty() ? "" : ", named: " + one.wrong);
    std::fflush(stdout);
  }
  const int most = test::count_95(options.repeats);
  fmt::print(
      "{} captures\nfalse alarms: {} (5 % of them, at most {})\n"
      "intervals that miss: {} (5 % of them, at most {})\n",
      options.repeats, wrong, most, missed, most);
  return wrong <= most && missed <= most ? 0 : 1;
}

int main_of(int argc, char** argv) {
  Options options;
  bool gravity = false, whole = false;
  std::vector<std::string> sizes;
  CLI::App app("Statistics of captures that hide nothing");
  app.add_option("-n,--repeats", options.repeats, "Captures");
  app.add_option("--first-seed", options.first, "Seed of the first");
  app.add_flag("--other-renderer", options.other_renderer,
               "Photos with other rays than the fit's: noise is not all that is left");
  app.add_flag("--other-mesh", options.other_mesh,
               "The truth is solved on a finer mesh; the intervals reach for it");
  app.add_flag("--hidden", gravity, "Self-weight is hidden; how often does a placebo come first?");
  app.add_option("--power", sizes,
                 "Effects (or `all`), each hidden in falling size: how often does it lead?")
      ->delimiter(',');
  app.add_flag("--discover", whole, "The whole search in each, the mesh and refits included");
  CLI11_PARSE(app, argc, argv);
  if (!sizes.empty()) return powers(options, sizes);
  if (whole) return searches(options);
  const int n = options.repeats, most = test::count_95(n);
  if (gravity) options.hidden = "hidden:\n  - {effect: gravity, rms_px: 1.5}\n";
  const Counts counts = count(options);
  fmt::print("{} captures\nplacebo named: {}\n", n, counts.placebo);
  if (gravity) return counts.placebo == 0 && counts.named == n ? 0 : 1;
  const double rms = std::sqrt(counts.spread / n);
  fmt::print(
      "false alarms: {} (5 % of them, at most {})\n"
      "intervals that miss: {} (5 % of them, at most {}); rms of (mu - true)/standard error "
      "{:.2f}\n",
      counts.named, most, counts.missed, most, rms);
  const bool held = counts.named <= most && counts.missed <= most && rms > 0.3;
  // Where the photos hold more than noise p-values tell so; what is not named is told by the fall.
  if (options.other_renderer || options.other_mesh) return held ? 0 : 1;
  const double ks = test::distance_from_uniform(counts.p);
  fmt::print("p-values: largest distance from uniform {:.3f} (5 % point {:.3f})\n", ks,
             test::distance_95(n));
  return held && ks <= test::distance_95(n) ? 0 : 1;
}

}  // namespace
}  // namespace hookeye

int main(int argc, char** argv) {
  try {
    return hookeye::main_of(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
