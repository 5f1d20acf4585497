// A fitted material as one energy density of F: what its curves and its card are drawn from.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "estimation/fit/fit.h"

namespace hookeye {

/// Energy density of the mean element: the weights of the parts averaged over the elements, each
/// part in its own material axes. What swells is told from the swollen state; factors of single
/// examples (softening) have no part in it.
class MeanEnergy {
 public:
  /// Over the elements where the part `of` acts; -1: over all.
  explicit MeanEnergy(const EnergyModel& energy, int of = -1);
  double psi(const Matrix3d& F) const;  ///< [stress]
  Matrix3d P(const Matrix3d& F) const;  ///< first Piola-Kirchhoff stress
  Matrix9d dP_dF(const Matrix3d& F) const;

 private:
  std::vector<std::pair<std::shared_ptr<const EnergyTerm>, double>> parts_;
};

/// Something to both sides of the fitted value of parameter `index`.
template <class T>
struct BothSides {
  Eigen::Index index;
  double apart;  ///< the two in the parameter
  T up, down;
};
/// d value / dp by central differences; zero where there is nothing beside. `value`: double(T).
template <class T, class Value>
VectorXd difference(const std::vector<BothSides<T>>& all, Eigen::Index parameters, Value&& value) {
  VectorXd out = VectorXd::Zero(parameters);
  for (const auto& one : all) out[one.index] = (value(one.up) - value(one.down)) / one.apart;
  return out;
}

/// The model at its fitted values and a little to both sides of each that the energy depends on:
/// derivatives of whatever follows from the energy, and the intervals that follow from them.
class EnergyNeighbourhood {
 public:
  explicit EnergyNeighbourhood(const Fitted& fitted);
  const Model& model() const { return model_; }
  /// Of a value that follows from the energy: double(const EnergyModel&).
  template <class Value>
  VectorXd gradient(Value&& value) const {
    return difference(beside_, covariance_.rows(), value);
  }
  /// The mean energies (MeanEnergy's `of`) beside the fitted one.
  std::vector<BothSides<MeanEnergy>> means(int of = -1) const;
  Eigen::Index parameters() const { return covariance_.rows(); }

  /// Half a 95 % interval to first order; by how much the value moves to where all pixels have it
  /// (Fitted::all_pixels); what an ever finer mesh would add to the value
  /// (Fitted::mesh_reach); whether it depends on a fitted number, and on one that the data leave
  /// open.
  struct Spread {
    double half = 0.0, shift = 0.0, reach = 0.0;
    bool fitted = false, open = false;
  };
  /// `value`: what the data leave open by more than that is open; what moves by no more than
  /// rounding does not depend on any fitted number.
  Spread spread(const VectorXd& gradient, double value) const;

 private:
  Model model_;
  Eigen::MatrixXd covariance_, undetermined_;
  VectorXd mesh_reach_, shift_;
  std::vector<BothSides<EnergyModel>> beside_;
};

/// 1 % and 99 % of what the points of the fitted examples reach, and always rest.
struct Visited {
  double low = 1.0, high = 1.0;
};
struct VisitedStretches {
  Visited isochoric;  ///< principal stretches at constant volume
  Visited stretch;    ///< principal stretches as they are
  Visited volume;     ///< det F
};
/// Over the elements where the part `of` acts; -1: over all. Without the swelling.
VisitedStretches visited_stretches(const Scene& scene, const Model& model, const Fitted& fitted,
                                   int of = -1);

}  // namespace hookeye
