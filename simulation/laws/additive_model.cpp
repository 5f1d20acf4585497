// Structure of additive models: building, refining, textbook laws in their form.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>

#include "simulation/laws/strain_components.h"

namespace hookeye {
namespace {

using Kind = StrainComponent::Kind;

const std::vector<std::pair<std::string, Kind>>& fixed_components() {
  static const std::vector<std::pair<std::string, Kind>> all = {
      {"E11", Kind::e11},   {"E22", Kind::e22},     {"E33", Kind::e33},
      {"E12", Kind::e12},   {"E13", Kind::e13},     {"E23", Kind::e23},
      {"trE", Kind::trace}, {"I1bar", Kind::i1bar}, {"J", Kind::volume}};
  return all;
}

std::optional<Kind> kind_of(const std::string& name) {
  for (const auto& [known, kind] : fixed_components())
    if (known == name) return kind;
  if (name.size() == 6 && name.rfind("fibre", 0) == 0 && name[5] >= '1' && name[5] <= '9')
    return Kind::fibre;
  return {};
}

/// Values of the addend's own function with `x` among its points: linear between them.
double interpolate(const std::vector<double>& at, const std::vector<double>& values, double x) {
  if (x <= at.front()) return values.front();
  if (x >= at.back()) return values.back();
  const auto above = std::upper_bound(at.begin(), at.end(), x) - at.begin();
  const double t = (x - at[above - 1]) / (at[above] - at[above - 1]);
  return (1 - t) * values[above - 1] + t * values[above];
}

}  // namespace

int AdditiveModel::size() const {
  int n = 0;
  for (const Addend& a : addends) n += a.fixed ? 0 : static_cast<int>(a.stiffness.size());
  return n;
}

Eigen::VectorXd AdditiveModel::values() const {
  Eigen::VectorXd all(size());
  Eigen::Index next = 0;
  for (const Addend& a : addends) {
    if (a.fixed) continue;
    all.segment(next, a.stiffness.size()) = a.stiffness;
    next += a.stiffness.size();
  }
  return all;
}

void AdditiveModel::set_values(const Eigen::VectorXd& values) {
  if (values.size() != size()) throw std::logic_error("additive: wrong number of control values");
  Eigen::Index next = 0;
  for (Addend& a : addends) {
    if (a.fixed) continue;
    a.stiffness = values.segment(next, a.stiffness.size());
    next += a.stiffness.size();
  }
}

const Addend* AdditiveModel::find(const std::string& name) const {
  for (const Addend& a : addends)
    if (a.name == name) return &a;
  return nullptr;
}

int component_index(AdditiveModel& model, const std::string& name) {
  for (size_t c = 0; c < model.components.size(); ++c)
    if (model.components[c].name == name) return static_cast<int>(c);
  const auto kind = kind_of(name);
  if (!kind) throw std::invalid_argument(fmt::format("there is no strain component `{}`", name));
  StrainComponent component;
  component.kind = *kind;
  component.name = name;
  model.components.push_back(component);
  return static_cast<int>(model.components.size()) - 1;
}

void add_addend(AdditiveModel& model, const std::string& name, std::vector<double> at,
                std::vector<double> at_second, const Eigen::VectorXd& stiffness) {
  Addend addend;
  addend.name = name;
  const size_t split = name.find('_');
  addend.first = component_index(model, name.substr(0, split));
  if (split != std::string::npos) addend.second = component_index(model, name.substr(split + 1));
  const StrainComponent& first = model.components[addend.first];
  const bool mirrored = first.shear() && !at.empty() && at.front() >= 0.0;
  addend.even = addend.second < 0 && (mirrored || first.kind == Kind::i1bar);
  addend.at = std::move(at);
  addend.at_second = std::move(at_second);
  addend.stiffness = stiffness;
  model.addends.push_back(std::move(addend));
}

std::optional<AdditiveModel> sum_of(const AdditiveModel& a, const AdditiveModel& b) {
  const auto same = [](const CylinderFrame& one, const CylinderFrame& other) {
    return one.axis == other.axis && one.center == other.center;
  };
  if (a.frame != b.frame || a.cylinder.has_value() != b.cylinder.has_value() ||
      (a.cylinder && !same(*a.cylinder, *b.cylinder)) ||
      (a.barrier_modulus > 0 && b.barrier_modulus > 0))
    return {};
  AdditiveModel out = a;
  if (b.barrier_modulus > 0) {
    out.barrier_modulus = b.barrier_modulus;
    out.barrier_below = b.barrier_below;
  }
  std::vector<int> moved;
  for (const StrainComponent& c : b.components) {
    const auto known = std::find_if(
        out.components.begin(), out.components.end(), [&](const StrainComponent& other) {
          return c.kind == other.kind && (c.kind != Kind::fibre || c.direction == other.direction);
        });
    moved.push_back(static_cast<int>(known - out.components.begin()));
    if (known == out.components.end()) out.components.push_back(c);
  }
  if (out.components.size() > static_cast<size_t>(laws::kMostComponents)) return {};
  for (Addend addend : b.addends) {
    addend.first = moved[addend.first];
    if (addend.second >= 0) addend.second = moved[addend.second];
    out.addends.push_back(std::move(addend));
  }
  return out;
}

AdditiveModel refined(const AdditiveModel& model, int index, double x, bool second) {
  AdditiveModel out = model;
  Addend& addend = out.addends[index];
  const Addend& old = model.addends[index];
  std::vector<double>& at = second ? addend.at_second : addend.at;
  const auto place = std::lower_bound(at.begin(), at.end(), x);
  if ((place != at.end() && *place == x) || at.size() >= kMostControlPoints) return out;
  at.insert(place, x);
  // Row by row or column by column a function of one variable.
  const size_t rows = old.at.size(), columns = old.second < 0 ? 1 : old.at_second.size();
  const size_t new_rows = rows + (second ? 0 : 1), new_columns = columns + (second ? 1 : 0);
  addend.stiffness.resize(static_cast<Eigen::Index>(new_rows * new_columns));
  const std::vector<double>& old_at = second ? old.at_second : old.at;
  for (size_t line = 0; line < (second ? rows : columns); ++line) {
    std::vector<double> values;
    for (size_t k = 0; k < old_at.size(); ++k)
      values.push_back(old.stiffness[static_cast<Eigen::Index>(second ? line * columns + k
                                                                      : k * columns + line)]);
    for (size_t k = 0; k < at.size(); ++k)
      addend.stiffness[static_cast<Eigen::Index>(second ? line * new_columns + k
                                                        : k * new_columns + line)] =
          interpolate(old_at, values, at[k]);
  }
  return out;
}

AdditiveModel additive_stvk(double lambda, double mu) {
  // lambda/2 tr(E)^2 + mu E:E = sum (lambda/2 + mu) Eii^2 + sum lambda Eii Ejj + sum 2 mu Eij^2.
  AdditiveModel model;
  const auto one = [](double value) { return Eigen::VectorXd::Constant(1, value); };
  for (const char* name : {"E11", "E22", "E33"})
    add_addend(model, name, {0.0}, {}, one(lambda + 2 * mu));
  for (const char* name : {"E11_E22", "E11_E33", "E22_E33"})
    add_addend(model, name, {0.0}, {0.0}, one(lambda));
  for (const char* name : {"E12", "E13", "E23"}) add_addend(model, name, {0.0}, {}, one(4 * mu));
  return model;
}

AdditiveModel additive_neo_hookean(double mu, double kappa) {
  AdditiveModel model;
  add_addend(model, "I1bar", {0.0}, {}, Eigen::VectorXd::Constant(1, mu));
  add_addend(model, "J", {0.0}, {}, Eigen::VectorXd::Constant(1, kappa));
  return model;
}

Eigen::MatrixXd cylinder_frames(const CylinderFrame& cylinder, const Matrix3Xd& centroids) {
  Eigen::MatrixXd frames(9, centroids.cols());
  for (Eigen::Index e = 0; e < centroids.cols(); ++e) {
    Eigen::Vector3d out = centroids.col(e) - cylinder.center;
    out -= out.dot(cylinder.axis) * cylinder.axis;
    // On the axis itself all directions across are alike.
    if (!(out.norm() > 1e-12 * centroids.norm())) out = cylinder.axis.unitOrthogonal();
    Matrix3d A;
    A.col(0) = out.normalized();
    A.col(2) = cylinder.axis;
    A.col(1) = A.col(2).cross(A.col(0));
    frames.col(e) = A.reshaped();
  }
  return frames;
}

std::optional<AdditiveModel> as_additive(const EnergyTerm& law) {
  if (const AdditiveModel* own = additive_model(law)) return *own;
  const Matrix9d D = law.dP_dF(Matrix3d::Identity());
  const double mu = 0.5 * (D(1, 1) + D(1, 3)), lambda = D(0, 4);
  if (law.name() == "neo-hookean") return additive_neo_hookean(mu, lambda + 2.0 / 3.0 * mu);
  if (law.name() == "stvk") return additive_stvk(lambda, mu);
  return {};
}

std::vector<bool> beyond_control_points(const AdditiveModel& model,
                                        const Eigen::VectorXd& strains) {
  std::vector<bool> out;
  const auto outside = [](const std::vector<double>& at, double e, bool even) {
    // A single point is a constant that is meant everywhere.
    if (at.size() < 2) return false;
    return even ? std::abs(e) > at.back() : e < at.front() || e > at.back();
  };
  for (const Addend& a : model.addends)
    out.push_back(!a.fixed && (outside(a.at, strains[a.first], a.even) ||
                               (a.second >= 0 && outside(a.at_second, strains[a.second], false))));
  return out;
}

Eigen::MatrixX3d addend_curve_basis(const AdditiveModel& model, int addend, double e) {
  return laws::CompiledAddend(model.addends[addend], 0).curve_basis(e);
}

Eigen::VectorXd addend_energy_basis(const AdditiveModel& model, int addend, double a, double b) {
  const Addend& own = model.addends[addend];
  AdditiveModel one = model;
  one.addends = {own};
  laws::Strains e{};
  e[own.first] = a;
  if (own.second >= 0) e[own.second] = b;
  Eigen::VectorXd basis(own.stiffness.size());
  for (Eigen::Index k = 0; k < basis.size(); ++k) {
    one.addends[0].stiffness = Eigen::VectorXd::Unit(basis.size(), k);
    basis[k] = laws::CompiledAddend(one.addends[0], 0).psi(e);
  }
  return basis;
}

Eigen::Vector3d addend_curve(const AdditiveModel& model, int addend, double e) {
  return addend_curve_basis(model, addend, e).transpose() * model.addends[addend].stiffness;
}

}  // namespace hookeye
