// Materials of a deck as laws here.
//
// *HYPERELASTIC has the volumetric energy sum 1/D_i (J - 1)^(2 i): kappa = 2/D1. NEO HOOKE C10 =
// mu/2; OGDEN sum 2 mu_i/alpha_i^2 (...), which is mu_i/alpha_i (...) with 2 mu_i/alpha_i. *ELASTIC
// is linear; of CalculiX between second Piola-Kirchhoff stress and Green strain, which is `stvk`.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "importers/deck_model.h"

namespace hookeye::solver_deck {
namespace {

std::vector<double> numbers_of(const Card& card) {
  std::vector<double> out;
  for (const CardLine& line : card.lines)
    for (const std::string& field : line.fields())
      out.push_back(field.empty() ? 0.0 : real(field, line.place));
  return out;
}

/// Bulk modulus of D1; where it is zero the programs take twenty times the shear modulus.
double bulk(double D1, double mu, const Card& card, Deck& deck) {
  if (D1 > 0) return 2 / D1;
  deck.say(card.place,
           "D1 is 0: kappa is taken as 20 times the shear modulus (a Poisson's ratio of 0.475)");
  return 20 * mu;
}

void say_higher(const std::vector<double>& values, size_t from, const Card& card, Deck& deck) {
  for (size_t i = from; i < values.size(); ++i)
    if (values[i] != 0) {
      deck.say(card.place, "D2 and above are left out: the laws here have one bulk modulus");
      return;
    }
}

/// Of powers of I1bar - 3 and one of I2bar - 3.
Law rubber(double c10, double c01, double c20, double c30, double D1, const Card& card,
           Deck& deck) {
  const double mu = 2 * (c10 + c01);
  if (!(mu > 0)) card.fault("the shear modulus at rest is not above zero", "C10 + C01 above zero");
  const double kappa = bulk(D1, mu, card, deck);
  if (c20 != 0 || c30 != 0)
    return {fmt::format("{{law: yeoh, c1: {}, c2: {}, c3: {}, kappa: {}}}", c10, c20, c30, kappa),
            {"c1", "c2", "c3"}};
  if (c01 != 0)
    return {fmt::format("{{law: mooney-rivlin, c10: {}, c01: {}, kappa: {}}}", c10, c01, kappa),
            {"c10", "c01"}};
  return {fmt::format("{{law: neo-hookean, mu: {}, kappa: {}}}", mu, kappa), {"mu"}};
}

Law ogden(const std::vector<double>& v, size_t n, const Card& card, Deck& deck) {
  std::vector<double> mu, alpha;
  double shear = 0;
  for (size_t i = 0; i < n; ++i) {
    if (v[2 * i + 1] == 0) card.fault("an exponent of the stretches is zero", "alpha_i not zero");
    alpha.push_back(v[2 * i + 1]);
    mu.push_back(2 * v[2 * i] / v[2 * i + 1]);
    shear += v[2 * i];
  }
  say_higher(v, 2 * n + 1, card, deck);
  return {fmt::format("{{law: ogden, mu: [{}], alpha: [{}], kappa: {}}}", fmt::join(mu, ", "),
                      fmt::join(alpha, ", "), bulk(v[2 * n], shear, card, deck)),
          {}};
}

/// N terms c_ij (I1bar - 3)^i (I2bar - 3)^j: those of order 1 first, j rising.
Law polynomial(std::vector<double> v, size_t n, const Card& card, Deck& deck) {
  const size_t terms = n * (n + 3) / 2;
  v.resize(std::max(v.size(), terms + n));
  say_higher(v, terms + 1, card, deck);
  const auto c = [&](size_t i) { return i < terms ? v[i] : 0.0; };
  const bool mixed = c(3) != 0 || c(4) != 0 || c(6) != 0 || c(7) != 0 || c(8) != 0;
  if (mixed || n > 3 || ((c(2) != 0 || c(5) != 0) && c(1) != 0)) {
    deck.say(card.place, "this polynomial is no law here: choose one of Mooney-Rivlin and Yeoh");
    return {};
  }
  return rubber(c(0), c(1), c(2), c(5), v[terms], card, deck);
}

Law elastic(const Card& card, Deck& deck) {
  const std::string type = capitals(card.option("TYPE"));
  if (!type.empty() && type != "ISO" && type != "ISOTROPIC") {
    deck.say(card.place, fmt::format("*ELASTIC of type {} is left out: write a law", type));
    return {};
  }
  const std::vector<double> v = numbers_of(card);
  if (v.size() < 2) card.fault("E and Poisson's ratio are missing", "E, nu");
  if (!(v[0] > 0) || !(v[1] > -1 && v[1] < 0.5))
    card.fault(fmt::format("E = {} and nu = {} are no solid", v[0], v[1]),
               "E above zero, nu between -1 and 0.5");
  if (card.lines.size() > 1)
    deck.say(card.lines[1].place, "moduli at further temperatures are left out");
  deck.say(card.place,
           "*ELASTIC becomes `stvk`, the same at small strains; for rubber and gel "
           "`neo-hookean` is better at large ones");
  const double mu = v[0] / (2 * (1 + v[1])), lambda = 2 * mu * v[1] / (1 - 2 * v[1]);
  return {fmt::format("{{law: stvk, lambda: {}, mu: {}}}", lambda, mu), {"lambda", "mu"}};
}

}  // namespace

Law law_of(const Card& card, Deck& deck) {
  if (card.word == "*ELASTIC") return elastic(card, deck);
  const auto is = [&](const char* name) { return card.has(name); };
  if (is("TEST DATA INPUT")) {
    deck.say(card.place, "a law told by test data is left out: write the law and its parameters");
    return {};
  }
  std::vector<double> v = numbers_of(card);
  const std::string order = card.option("N");
  const size_t n =
      order.empty() ? 1 : static_cast<size_t>(std::clamp(whole(order, card.place), 1, 6));
  const auto need = [&](size_t count) {
    if (v.size() < count)
      card.fault(fmt::format("the law has {} numbers", v.size()), fmt::format("{} of them", count));
    v.resize(std::max(v.size(), size_t{30}));
  };
  if (is("NEO HOOKE")) {
    need(1);
    return rubber(v[0], 0, 0, 0, v[1], card, deck);
  }
  if (is("MOONEY-RIVLIN")) {
    need(2);
    return rubber(v[0], v[1], 0, 0, v[2], card, deck);
  }
  if (is("YEOH") || (is("REDUCED POLYNOMIAL") && n <= 3)) {
    const size_t terms = is("YEOH") ? 3 : n;
    need(terms);
    say_higher(v, terms + 1, card, deck);
    return rubber(v[0], 0, terms > 1 ? v[1] : 0, terms > 2 ? v[2] : 0, v[terms], card, deck);
  }
  if (is("OGDEN")) {
    need(2 * n);
    return ogden(v, n, card, deck);
  }
  const bool other = is("ARRUDA-BOYCE") || is("MARLOW") || is("VAN DER WAALS") || is("USER") ||
                     is("REDUCED POLYNOMIAL") || is("VALANIS-LANDEL") || is("ANISOTROPIC");
  if (!other) {
    need(n * (n + 3) / 2);
    return polynomial(v, n, card, deck);
  }
  deck.say(card.place, "this law of *HYPERELASTIC is not here: write one of docs/capture.md");
  return {};
}

}  // namespace hookeye::solver_deck
