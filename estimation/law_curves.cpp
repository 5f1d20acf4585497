// What the data say of a material: its energy under a pull and under pressure,
// with the band that the parameters' covariance gives, over the strains that the examples visit.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "estimation/energy_curves.h"
#include "estimation/normal_equations.h"

namespace hookeye {
namespace {

using nlohmann::json;

/// Energy density with the parts' weights averaged over the body.
class MeanEnergy {
 public:
  explicit MeanEnergy(const EnergyModel& energy) : energy_(energy) {
    for (const auto& part : energy.parts)
      weight_.push_back(part.weight.size() ? part.weight.mean() : 1.0);
  }
  double psi(const Matrix3d& F) const {
    double sum = 0.0;
    for (size_t k = 0; k < weight_.size(); ++k) sum += weight_[k] * energy_.parts[k].term->psi(F);
    return sum;
  }

 private:
  EnergyModel energy_;
  std::vector<double> weight_;
};

/// One family of strains: F over its coordinate, 1 at rest.
struct Family {
  std::string name, axis;
  int direction;  ///< of the pull; -1: the same all round
  Matrix3d F(double x) const {
    if (direction < 0) return std::cbrt(x) * Matrix3d::Identity();
    Eigen::Vector3d stretch = Eigen::Vector3d::Constant(1.0 / std::sqrt(x));
    stretch[direction] = x;
    return stretch.asDiagonal();
  }
};

struct Visited {
  double low = 1.0, high = 1.0;  ///< 1 % and 99 % of the points, and always rest
  void cover(std::vector<double>& values) {
    if (values.empty()) return;
    low = std::min(low, quantile(values, 0.01));
    high = std::max(high, quantile(values, 0.99));
  }
};

/// Principal stretches at constant volume, and volume ratios, of the fitted examples.
std::array<Visited, 2> visited(const Scene& scene, const Model& model, const Fitted& fitted) {
  std::vector<double> shortest, longest, volume;
  const TetMesh& mesh = scene.body->mesh;
  for (const auto& example : fitted.evaluation.examples) {
    if (example.held_out) continue;
    const auto all = deformation_gradients(mesh, example.equilibrium->q);
    const size_t points = all.size() / static_cast<size_t>(mesh.size());
    for (size_t i = 0; i < all.size(); ++i) {
      const Eigen::VectorXd& g = model.energy.swelling;
      const Matrix3d F =
          g.size() ? Matrix3d(all[i] / g[static_cast<Eigen::Index>(i / points)]) : all[i];
      const double J = F.determinant();
      const Eigen::SelfAdjointEigenSolver<Matrix3d> C(F.transpose() * F, Eigen::EigenvaluesOnly);
      longest.push_back(std::sqrt(C.eigenvalues()[2]) / std::cbrt(J));
      shortest.push_back(std::sqrt(std::max(C.eigenvalues()[0], 0.0)) / std::cbrt(J));
      volume.push_back(J);
    }
  }
  std::array<Visited, 2> out;
  out[0].cover(shortest);
  out[0].cover(longest);
  out[1].cover(volume);
  return out;
}

/// Are the three pulls one? Compared at a stretch that no example needs to reach.
bool isotropic(const MeanEnergy& energy) {
  const double x = energy.psi(Family{"", "", 0}.F(1.3)), y = energy.psi(Family{"", "", 1}.F(1.3)),
               z = energy.psi(Family{"", "", 2}.F(1.3));
  return std::max(std::abs(y - x), std::abs(z - x)) <= 1e-9 * std::abs(x);
}

/// Central differences of the model's energies by every parameter that the energy depends on.
std::vector<std::pair<Eigen::Index, std::array<MeanEnergy, 2>>> neighbours(
    const ModelForm& form, const VectorXd& p, const Eigen::MatrixXd& covariance,
    std::vector<double>& step) {
  std::vector<std::pair<Eigen::Index, std::array<MeanEnergy, 2>>> out;
  Eigen::Index k = 0;
  for (const auto& ingredient : form.ingredients)
    for (const Parameter& parameter : ingredient->parameters()) {
      const Eigen::Index own = k++;
      const double deviation = std::sqrt(std::max(0.0, covariance(own, own)));
      if (!ingredient->touches().energy || deviation == 0.0) continue;
      VectorXd up = p, down = p;
      const double scale = parameter.positive && p[own] > 0.0 ? p[own] : parameter.typical;
      const double h = std::min(deviation, 1e-3 * scale);
      up[own] += h;
      down[own] -= h;
      step.push_back(2.0 * h);
      out.push_back(
          {own, {MeanEnergy(form.realise(up).energy), MeanEnergy(form.realise(down).energy)}});
    }
  return out;
}

}  // namespace

json law_curves(const Scene& scene, const Fitted& fitted) {
  json out = json::array();
  const Model model = fitted.form.realise(fitted.p);
  if (model.energy.parts.empty()) return out;
  const MeanEnergy energy(model.energy);
  const Eigen::MatrixXd covariance =
      parameter_covariance(fitted.evaluation, fitted.form.parameters(), fitted.p).all();
  std::vector<double> step;
  const auto near = neighbours(fitted.form, fitted.p, covariance, step);
  const auto [stretch, volume] = visited(scene, model, fitted);
  std::vector<Family> families;
  if (isotropic(energy))
    families.push_back({"pull", "stretch at constant volume", 0});
  else
    for (int i = 0; i < 3; ++i)
      families.push_back({std::string("pull along ") + "xyz"[i], "stretch at constant volume", i});
  families.push_back({"volume", "volume ratio J", -1});
  for (const Family& family : families) {
    const Visited& seen = family.direction < 0 ? volume : stretch;
    const double margin = 0.1 * std::max(seen.high - seen.low, 0.02);
    json one = {{"name", family.name},
                {"axis", family.axis},
                {"unit", scene.capture.units.stress()},
                {"visited", {seen.low, seen.high}}};
    for (int i = 0; i < kCurvePoints; ++i) {
      const double x =
          seen.low - margin + (seen.high - seen.low + 2.0 * margin) * i / (kCurvePoints - 1);
      const Matrix3d F = family.F(x);
      const double value = energy.psi(F);
      VectorXd gradient = VectorXd::Zero(fitted.p.size());
      for (size_t k = 0; k < near.size(); ++k)
        gradient[near[k].first] = (near[k].second[0].psi(F) - near[k].second[1].psi(F)) / step[k];
      const double half = kNormal95 * std::sqrt(std::max(0.0, gradient.dot(covariance * gradient)));
      one["stretch"].push_back(x);
      one["value"].push_back(value);
      push_band(one, value, half, fitted.mesh_reach.size() ? gradient.dot(fitted.mesh_reach) : 0.0);
    }
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace hookeye
