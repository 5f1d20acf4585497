#include "estimation/fit/mean_energy.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/distributions.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/fit/energy_curves.h"

namespace hookeye {
namespace {

/// Whether a part acts in element e.
bool acts(const EnergyModel& energy, int part, Eigen::Index e) {
  if (part < 0) return true;
  const VectorXd& weight = energy.parts.at(static_cast<size_t>(part)).weight;
  return weight.size() == 0 || weight[e] > 0.0;
}

double mean_weight(const EnergyModel& energy, const EnergyModel::Part& part, int of) {
  if (part.weight.size() == 0) return 1.0;
  double sum = 0.0, count = 0.0;
  for (Eigen::Index e = 0; e < part.weight.size(); ++e)
    if (acts(energy, of, e)) sum += part.weight[e], count += 1.0;
  return sum / std::max(count, 1.0);
}

void cover(Visited& range, std::vector<double>& values) {
  if (values.empty()) return;
  range.low = std::min(range.low, quantile(values, 0.01));
  range.high = std::max(range.high, quantile(values, 0.99));
}

}  // namespace

MeanEnergy::MeanEnergy(const EnergyModel& energy, int of) {
  for (const auto& part : energy.parts)
    if (const double weight = mean_weight(energy, part, of); weight != 0.0)
      parts_.emplace_back(part.term, weight);
}

double MeanEnergy::psi(const Matrix3d& F) const {
  double sum = 0.0;
  for (const auto& [term, weight] : parts_) sum += weight * term->psi(F);
  return sum;
}

Matrix3d MeanEnergy::P(const Matrix3d& F) const {
  Matrix3d sum = Matrix3d::Zero();
  for (const auto& [term, weight] : parts_) sum += weight * term->P(F);
  return sum;
}

Matrix9d MeanEnergy::dP_dF(const Matrix3d& F) const {
  Matrix9d sum = Matrix9d::Zero();
  for (const auto& [term, weight] : parts_) sum += weight * term->dP_dF(F);
  return sum;
}

EnergyNeighbourhood::EnergyNeighbourhood(const Fitted& fitted)
    : model_(fitted.form.realise(fitted.p)), mesh_reach_(fitted.mesh_reach) {
  const ParameterCovariance known =
      parameter_covariance(fitted.evaluation, fitted.form.parameters(), fitted.p);
  covariance_ = known.all();
  if (fitted.all_pixels) shift_ = fitted.all_pixels->value - fitted.p;
  undetermined_ = known.undetermined;
  Eigen::Index k = 0;
  for (const auto& ingredient : fitted.form.ingredients)
    for (const Parameter& parameter : ingredient->parameters()) {
      const Eigen::Index own = k++;
      const double deviation = std::sqrt(std::max(0.0, covariance_(own, own)));
      if (!ingredient->touches().energy || deviation == 0.0) continue;
      VectorXd up = fitted.p, down = fitted.p;
      const double scale =
          parameter.positive && fitted.p[own] > 0.0 ? fitted.p[own] : parameter.typical;
      const double h = std::min(deviation, 1e-3 * scale);
      up[own] += h;
      down[own] -= h;
      beside_.push_back(
          {own, 2.0 * h, fitted.form.realise(up).energy, fitted.form.realise(down).energy});
    }
}

std::vector<BothSides<MeanEnergy>> EnergyNeighbourhood::means(int of) const {
  std::vector<BothSides<MeanEnergy>> out;
  for (const auto& one : beside_)
    out.push_back({one.index, one.apart, MeanEnergy(one.up, of), MeanEnergy(one.down, of)});
  return out;
}

EnergyNeighbourhood::Spread EnergyNeighbourhood::spread(const VectorXd& gradient,
                                                        double value) const {
  Spread out;
  if (gradient.size() == 0) return out;
  out.half = kNormal95 * std::sqrt(std::max(0.0, gradient.dot(covariance_ * gradient)));
  out.open = std::sqrt(std::max(0.0, gradient.dot(undetermined_ * gradient))) > std::abs(value);
  for (const auto& one : beside_)
    out.fitted |= std::abs(gradient[one.index]) * one.apart > 1e-11 * std::abs(value);
  if (shift_.size()) out.shift = gradient.dot(shift_);
  if (mesh_reach_.size()) out.reach = gradient.dot(mesh_reach_);
  return out;
}

VisitedStretches visited_stretches(const Scene& scene, const Model& model, const Fitted& fitted,
                                   int of) {
  std::array<std::vector<double>, 2> all, isochoric;  // the shortest, the longest
  std::vector<double> volume;
  const TetMesh& mesh = scene.body->mesh;
  const VectorXd& g = model.energy.swelling;
  for (const auto& example : fitted.evaluation.examples) {
    if (example.held_out) continue;
    const auto gradients = deformation_gradients(mesh, example.equilibrium->q);
    const size_t points = gradients.size() / static_cast<size_t>(mesh.size());
    for (size_t i = 0; i < gradients.size(); ++i) {
      const auto e = static_cast<Eigen::Index>(i / points);
      if (!acts(model.energy, of, e)) continue;
      const Matrix3d F = g.size() ? Matrix3d(gradients[i] / g[e]) : gradients[i];
      const double J = F.determinant();
      const Eigen::SelfAdjointEigenSolver<Matrix3d> C(F.transpose() * F, Eigen::EigenvaluesOnly);
      for (const size_t k : {0, 1}) {
        all[k].push_back(std::sqrt(std::max(C.eigenvalues()[k == 0 ? 0 : 2], 0.0)));
        isochoric[k].push_back(all[k].back() / std::cbrt(J));
      }
      volume.push_back(J);
    }
  }
  VisitedStretches out;
  for (const size_t k : {0, 1}) cover(out.stretch, all[k]), cover(out.isochoric, isochoric[k]);
  cover(out.volume, volume);
  return out;
}

}  // namespace hookeye
