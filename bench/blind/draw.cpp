#include "bench/blind/draw.h"

#include <fmt/format.h>

#include <random>
#include <sstream>

namespace hookeye::blind {

namespace {

/// The same numbers with every standard library.
class Dice {
 public:
  Dice(const std::string& effect, unsigned seed) {
    std::vector<unsigned> words = {seed};
    words.insert(words.end(), effect.begin(), effect.end());
    std::seed_seq sequence(words.begin(), words.end());
    random_.seed(sequence);
  }
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  double sign() { return random_() % 2 ? 1.0 : -1.0; }

 private:
  std::mt19937_64 random_;
};

}  // namespace

std::vector<std::string> effects_of(const std::string& hidden) {
  std::vector<std::string> out;
  std::istringstream names(hidden);
  for (std::string name; std::getline(names, name, '+');)
    if (name != "none") out.push_back(name);
  return out;
}

std::string draw_recipe(const std::string& hidden, unsigned seed, const Drawing& drawing) {
  Dice dice(hidden, seed);
  const char* shapes[] = {"block", "cylinder", "blob"};
  const double height = dice(50, 70), width = dice(0.42, 0.58) * height;
  const double mu = dice(0.02, 0.08), turn = dice(-180, 180);
  const double coarser = drawing.small ? 1.54 : 1.0;  // 400 px to 260
  std::string out = fmt::format(
      "hookeye_recipe: 1\ntitle: blind {} {}\nseed: {}\n"
      "body:\n  shape: {}\n  size: [{:.2f}, {:.2f}, {:.2f}]\n  taper: {:.3f}\n  bumps: {:.3f}\n"
      "  mesh: {{edge: {:.2f}}}\n  density: 1.07e-9\n"
      "  texture: {{texel: {:.3f}, speckle: {:.2f}, cover: 0.55}}\n",
      "capture", seed, seed, shapes[static_cast<int>(dice(0, 3)) % 3], width,
      dice(0.8, 1.0) * width, height, dice(0.85, 1.1), dice(0.02, 0.07), coarser * 0.14 * height,
      coarser * height / 400, coarser * height / dice(28, 40));
  out += fmt::format(
      "material:\n  law: neo-hookean\n  true: {{mu: {:.5f}, kappa_over_mu: {:.2f}}}\n"
      "  told: {{mu: {:.5f}}}\n  fit: [mu]\n",
      mu, dice(8, 16), mu * dice(0.8, 1.25));
  out += fmt::format(
      "cameras: {{count: 2, size: [{}], distance: {:.2f}, focal: {:.0f}, azimuth: {:.1f}, "
      "spread: {:.1f}, elevation: {:.1f}, look_at: 0.52}}\n",
      drawing.small ? "200, 260" : "300, 400", 6.5 + drawing.step_back, 1650 / coarser, turn,
      dice(60, 100), dice(8, 28));
  const double sun = (turn + dice(0, 60)) * 3.14159265358979 / 180.0;
  out +=
      fmt::format("light: {{ambient: {:.3f}, toward: [{:.3f}, {:.3f}, {:.3f}], strength: 0.6}}\n",
                  dice(0.2, 0.38), std::cos(sun), std::sin(sun), dice(0.3, 0.9));
  const double bend = 0.014, side = turn / 180.0 * 3.14159265358979;
  const double poke = -dice(0.03, 0.045);
  const double oblique_z = dice(0.15, 0.3);
  const double oblique_y = bend * dice(-1, 1), oblique_x = bend * dice(-1, 1);
  const double press = -dice(0.06, 0.1);
  const double twist = dice.sign() * dice(18, 32);
  const double side_y = bend * dice(0.8, 1.2) * std::sin(side);
  const double side_x = bend * dice(0.8, 1.2) * std::cos(side);
  out += fmt::format(
      "examples:\n  rest: {{}}\n  pull: {{force: [0, 0, {:.3f}]}}\n"
      "  side: {{force: [{:.4f}, {:.4f}, 0]}}\n  twist: {{rotate: {:.1f}}}\n",
      dice(0.3, 0.45), side_x, side_y, twist);
  if (!drawing.small) out += fmt::format("  press: {{move: [0, 0, {:.4f}]}}\n", press);
  out += fmt::format("  val_oblique: {{use: validate, force: [{:.4f}, {:.4f}, {:.3f}]}}\n",
                     oblique_x, oblique_y, oblique_z);
  if (!drawing.small)
    out +=
        fmt::format("  val_poke: {{use: validate, region: side, force: [{:.4f}, 0, 0]}}\n", poke);
  const auto effects = effects_of(hidden);
  if (!effects.empty()) out += "hidden:\n";
  for (const std::string& effect : effects)
    out += fmt::format("  - {{effect: {}, rms_px: {:.3f}, times: {:g}}}\n", effect,
                       drawing.size * dice(1.5, 3.5), drawing.size);
  return out;
}

}  // namespace hookeye::blind
