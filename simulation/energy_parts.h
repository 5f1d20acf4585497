// The sum over the parts of an EnergyModel at a point, for the loops over elements.
#pragma once

#include <utility>
#include <vector>

#include "simulation/batch_term.h"
#include "simulation/energy_model.h"

namespace hookeye {

/// The parts of a model, by how they are asked. The model must outlive it.
struct EnergyParts {
  explicit EnergyParts(const EnergyModel& all) : model(all) {
    for (const auto& part : all.parts) {
      const auto* batch =
          part.frames.size() == 0 ? dynamic_cast<const BatchTerm*>(part.term.get()) : nullptr;
      if (batch)
        together.emplace_back(&part, batch);
      else
        single.push_back(&part);
    }
  }
  const EnergyModel& model;
  std::vector<const EnergyModel::Part*> single;
  std::vector<std::pair<const EnergyModel::Part*, const BatchTerm*>> together;

  static double weight(const EnergyModel::Part& part, int e) {
    return part.weight.size() ? part.weight[e] : 1.0;
  }
  double swelling(int e) const { return model.swelling.size() ? model.swelling[e] : 1.0; }

  // Of the parts that are asked point by point: psi = w g^3 psi(F/g), P = w g^2 P(F/g),
  // dP/dF = w g dP/dF(F/g).
  double psi(int e, const Matrix3d& F) const {
    const double g = swelling(e);
    double sum = 0;
    for (const auto* part : single) sum += weight(*part, e) * part->psi(e, F / g);
    return g * g * g * sum;
  }
  Matrix3d P(int e, const Matrix3d& F) const {
    const double g = swelling(e);
    Matrix3d sum = Matrix3d::Zero();
    for (const auto* part : single) sum += weight(*part, e) * part->P(e, F / g);
    return g * g * sum;
  }
  Matrix9d dP_dF(int e, const Matrix3d& F) const {
    const double g = swelling(e);
    Matrix9d sum = Matrix9d::Zero();
    for (const auto* part : single) sum += weight(*part, e) * part->dP_dF(e, F / g);
    return g * sum;
  }

  /// Of the others, at F.col(k) in element[k]: a column each, as long as dP/dF (81).
  Eigen::MatrixXd dP_dF_together(const std::vector<int>& element, const Matrix9Xd& F) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(81, F.cols());
    if (together.empty()) return sum;
    Matrix9Xd elastic = F;
    for (Eigen::Index k = 0; k < F.cols(); ++k) elastic.col(k) /= swelling(element[k]);
    for (const auto& [part, term] : together) {
      const Eigen::MatrixXd D = term->dP_dF_of(elastic);
      for (Eigen::Index k = 0; k < F.cols(); ++k)
        sum.col(k) += weight(*part, element[k]) * swelling(element[k]) * D.col(k);
    }
    return sum;
  }
};

}  // namespace hookeye
