// The energy as materials of sets of elements: what isotropic rubber and stiffnesses of the Green
// strain can say of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "exporters/solver_model.h"
#include "simulation/additive.h"

namespace hookeye {
namespace {

/// More different weights than this are rounded to steps of kStep in their logarithm.
constexpr size_t kManyWeights = 64;
constexpr double kStep = 0.005;

/// Energies that sum up, and what does not fit in.
struct Sum {
  Rubber rubber;
  Stiffness6 linear = Stiffness6::Zero();
};

/// C_ijkl at rest by Voigt's order, for laws without stress there.
Stiffness6 stiffness_at_rest(const EnergyTerm& law) {
  constexpr int I[] = {0, 1, 2, 1, 0, 0}, J[] = {0, 1, 2, 2, 2, 1};
  const Matrix9d D = law.dP_dF(Matrix3d::Identity());
  Stiffness6 C;
  for (int a = 0; a < 6; ++a)
    for (int b = 0; b < 6; ++b) C(a, b) = D(I[a] + 3 * J[a], I[b] + 3 * J[b]);
  return 0.5 * (C + C.transpose());
}

/// Shear and bulk modulus of the isotropic stiffness nearest to C (Voigt's mean).
std::pair<double, double> mean_moduli(const Stiffness6& C) {
  const double volume = C.topLeftCorner<3, 3>().sum();
  const double all = C.diagonal().head<3>().sum() + 2 * C.diagonal().tail<3>().sum();
  return {(3 * all - volume) / 30, volume / 9};
}

std::map<std::string, double> values_of(const EnergyTerm& law) {
  std::map<std::string, double> out;
  for (const Parameter& p : law.parameters(Units{"mm", "N"})) out[p.name] = p.value;
  return out;
}

Rubber rubber_of_ogden(const EnergyTerm& law) {
  const auto value = values_of(law);
  Rubber out;
  for (int i = 1; value.count(fmt::format("mu{}", i)); ++i)
    out.ogden.push_back({value.at(fmt::format("mu{}", i)), value.at(fmt::format("alpha{}", i))});
  out.kappa = value.at("kappa");
  return out;
}

/// Laws that are rubber and no more. Empty: another.
std::optional<Rubber> as_rubber(const EnergyTerm& law) {
  const auto value = values_of(law);
  Rubber out;
  if (law.name() == "neo-hookean") {
    const auto [mu, kappa] = mean_moduli(stiffness_at_rest(law));
    out.c10 = 0.5 * value.at("mu");
    out.kappa = value.count("kappa") ? value.at("kappa") : kappa;
    return out;
  }
  if (law.name() == "mooney-rivlin") {
    out.c10 = value.at("c10"), out.c01 = value.at("c01"), out.kappa = value.at("kappa");
    return out;
  }
  if (law.name() == "yeoh") {
    out.c10 = value.at("c1"), out.c20 = value.at("c2"), out.c30 = value.at("c3");
    out.kappa = value.at("kappa");
    return out;
  }
  if (law.name() == "ogden") return rubber_of_ogden(law);
  return {};
}

/// An additive model of constants alone: neo-Hooke by I1bar and J, a stiffness by the strains.
std::optional<Sum> as_constants(const EnergyTerm& law) {
  const AdditiveModel* model = additive_model(law);
  if (!model || model->cylinder) return {};
  Sum out;
  for (const Addend& a : model->addends) {
    using Kind = StrainComponent::Kind;
    const Kind kind = model->components[a.first].kind;
    if (a.stiffness.size() != 1 || kind == Kind::fibre) return {};
    if (a.second >= 0 && (kind == Kind::volume || kind == Kind::i1bar ||
                          model->components[a.second].kind == Kind::volume ||
                          model->components[a.second].kind == Kind::fibre))
      return {};
    if (kind == Kind::i1bar) out.rubber.c10 += 0.5 * a.stiffness[0];
    if (kind == Kind::volume) out.rubber.kappa += a.stiffness[0];
  }
  out.linear = stiffness_at_rest(law) -
               stiffness_at_rest(*neo_hookean(2 * out.rubber.c10, out.rubber.kappa));
  if (out.linear.norm() < 1e-9 * stiffness_at_rest(law).norm()) out.linear.setZero();
  return out;
}

void add(const Rubber& more, double factor, Rubber& sum) {
  const Rubber own = more.scaled(factor);
  sum.c10 += own.c10, sum.c01 += own.c01, sum.c20 += own.c20, sum.c30 += own.c30;
  sum.kappa += own.kappa;
  sum.ogden.insert(sum.ogden.end(), own.ogden.begin(), own.ogden.end());
}

/// Adds factor times the law. What no material says goes into `lacks`, a law's name each.
void add(const EnergyTerm& law, double factor, Sum& sum, std::set<std::string>& lacks) {
  if (factor == 0.0) return;
  if (const auto* terms = terms_of(law)) {
    for (const WeightedTerm& t : *terms) add(*t.term, factor * t.coefficient, sum, lacks);
    return;
  }
  if (const auto rubber = as_rubber(law)) {
    add(*rubber, factor, sum.rubber);
    return;
  }
  if (law.name() == "stvk" || law.name() == "orthotropic" || law.name() == "anisotropic") {
    sum.linear += factor * stiffness_at_rest(law);
    return;
  }
  if (const auto constants = as_constants(law)) {
    add(constants->rubber, factor, sum.rubber);
    sum.linear += factor * constants->linear;
    return;
  }
  if (law.name() == "fibre" || law.name() == "pulling fibre") {
    lacks.insert(fmt::format("the term `{}` of the energy (fibres) is left out", law.name()));
    return;
  }
  const auto [mu, kappa] = mean_moduli(stiffness_at_rest(law));
  lacks.insert(
      fmt::format("the term `{}` of the energy is replaced by neo-Hooke of its mean moduli at rest",
                  law.name()));
  Rubber stand_in;
  stand_in.c10 = 0.5 * mu, stand_in.kappa = kappa;
  add(stand_in, factor, sum.rubber);
}

/// Weights that are written, one a part and element: as they are, or rounded where they are many.
Eigen::MatrixXd written_weights(const EnergyModel& energy, int elements,
                                std::vector<std::string>& lacks) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(energy.parts.size()), elements);
  std::set<std::vector<double>> different;
  for (int e = 0; e < elements; ++e) {
    for (Eigen::Index p = 0; p < out.rows(); ++p) {
      const VectorXd& weight = energy.parts[static_cast<size_t>(p)].weight;
      out(p, e) = weight.size() ? weight[e] : 1.0;
    }
    different.insert({out.col(e).data(), out.col(e).data() + out.rows()});
  }
  if (different.size() <= kManyWeights) return out;
  for (double& w : out.reshaped())
    if (w > 0 && w != 1.0) w = std::exp(kStep * std::round(std::log(w) / kStep));
  lacks.push_back(fmt::format(
      "the stiffness varies from element to element: it is rounded to steps of {:.1f} %, so that "
      "elements share materials",
      100 * kStep));
  return out;
}

}  // namespace

bool Rubber::none() const {
  return c10 == 0 && c01 == 0 && c20 == 0 && c30 == 0 && kappa == 0 && ogden.empty();
}

Rubber Rubber::scaled(double factor) const {
  Rubber out{c10 * factor, c01 * factor, c20 * factor, c30 * factor, kappa * factor, ogden};
  for (Ogden& term : out.ogden) term.mu *= factor;
  return out;
}

double Rubber::mu() const {
  double out = 2 * (c10 + c01);
  for (const Ogden& term : ogden) out += 0.5 * term.mu * term.alpha;
  return out;
}

double Rubber::some_kappa() const {
  const double size = std::abs(c10) + std::abs(c01) + std::abs(c20) + std::abs(c30);
  return kappa != 0 ? kappa : 1e-6 * (size > 0 ? 2 * size : 1.0);
}

std::vector<Rubber::Ogden> Rubber::as_ogden() const {
  std::vector<Ogden> all = ogden, out;
  if (c10 != 0.0) all.push_back({2 * c10, 2.0});
  if (c01 != 0.0) all.push_back({-2 * c01, -2.0});
  for (const Ogden& term : all) {
    const auto same = std::find_if(out.begin(), out.end(),
                                   [&](const Ogden& other) { return other.alpha == term.alpha; });
    if (same == out.end())
      out.push_back(term);
    else
      same->mu += term.mu;
  }
  return out;
}

std::vector<SolverMaterial> solver_materials(const EnergyModel& energy, const TetMesh& mesh,
                                             std::vector<std::string>& lacks) {
  const Eigen::MatrixXd weights = written_weights(energy, mesh.size(), lacks);
  std::map<std::vector<double>, std::vector<int>> sets;
  for (int e = 0; e < mesh.size(); ++e)
    sets[{weights.col(e).data(), weights.col(e).data() + weights.rows()}].push_back(e);
  std::vector<SolverMaterial> out;
  std::set<std::string> lacking;
  for (const auto& [factors, elements] : sets) {
    Sum sum;
    for (size_t p = 0; p < factors.size(); ++p)
      add(*energy.parts[p].term, factors[p], sum, lacking);
    out.push_back({fmt::format("MATERIAL{}", out.size() + 1), elements, sum.rubber, sum.linear});
  }
  lacks.insert(lacks.end(), lacking.begin(), lacking.end());
  return out;
}

}  // namespace hookeye
