#include "estimation/fit/lost_ellipticity.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "simulation/ellipticity.h"
#include "simulation/energy_parts.h"

namespace hookeye {

using nlohmann::json;

namespace {

/// Of an element's points the most strained and the most compressed: Green strain has no limit in
/// tension and ends at -1/2 in compression, where laws fail first.
std::vector<Matrix3d> extremes(const Matrix3d* F, size_t points) {
  double most = -1.0, least = std::numeric_limits<double>::infinity();
  size_t strained = 0, compressed = 0;
  for (size_t i = 0; i < points; ++i) {
    const Matrix3d C = F[i].transpose() * F[i];
    const double strain = (C - Matrix3d::Identity()).norm();
    const double stretch2 = Eigen::SelfAdjointEigenSolver<Matrix3d>()
                                .computeDirect(C, Eigen::EigenvaluesOnly)
                                .eigenvalues()[0];
    if (strain > most) most = strain, strained = i;
    if (stretch2 < least) least = stretch2, compressed = i;
  }
  if (strained == compressed) return {F[strained]};
  return {F[strained], F[compressed]};
}

}  // namespace

LostEllipticity lost_ellipticity(const TetMesh& mesh, const EnergyModel& energy,
                                 const VectorXd& q) {
  constexpr int kStarts = 8;  // a sweep
  LostEllipticity out{std::numeric_limits<double>::infinity(), -1, Matrix9d::Zero(), 0};
  const auto all = deformation_gradients(mesh, q);
  const size_t points = all.size() / static_cast<size_t>(mesh.size());
  const EnergyParts parts(energy);
  constexpr int kBlock = 4096;
  for (int first = 0; first < mesh.size(); first += kBlock) {
    std::vector<int> element;
    std::vector<Matrix3d> F;
    for (int e = first; e < std::min(first + kBlock, mesh.size()); ++e)
      for (const Matrix3d& one : extremes(all.data() + static_cast<size_t>(e) * points, points))
        element.push_back(e), F.push_back(one);
    Matrix9Xd columns(9, static_cast<Eigen::Index>(F.size()));
    for (size_t k = 0; k < F.size(); ++k)
      columns.col(static_cast<Eigen::Index>(k)) = F[k].reshaped();
    const Eigen::MatrixXd together = parts.dP_dF_together(element, columns);
    int lost = -1;
    for (size_t k = 0; k < F.size(); ++k) {
      Matrix9d D = parts.dP_dF(element[k], F[k]);
      D += together.col(static_cast<Eigen::Index>(k)).reshaped(9, 9);
      const double value = ellipticity(D, kStarts, true).smallest;
      if (value < out.smallest) out.smallest = value, out.element = element[k], out.dP_dF = D;
      if (value <= 0.0 && std::exchange(lost, element[k]) != element[k]) ++out.elements;
    }
  }
  return out;
}

json lost_ellipticity(const Scene& scene, const Fitted& fitted) {
  const Model realised = fitted.form.realise(fitted.p);
  std::optional<LostEllipticity> worst;
  json out;
  int lost = 0;
  for (const auto& example : fitted.evaluation.examples) {
    const auto here = lost_ellipticity(scene.body->mesh, realised.energy_of(example.example),
                                       example.equilibrium->q);
    lost += here.elements;
    if (worst && here.smallest >= worst->smallest) continue;
    worst = here;
    out["example"] = scene.capture.examples[example.example].name;
    out["element"] = here.element;
  }
  if (!worst) return out;
  out["smallest"] = ellipticity(worst->dP_dF).smallest;  // looked at again, with all starts
  out["elements_lost"] = lost;
  return out;
}

}  // namespace hookeye
