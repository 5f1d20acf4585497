// Derivatives of the realised model by its parameters at fixed q: central differences of assembly
// and of the photos' numbers, or what an ingredient knows better.
#pragma once

#include "estimation/evaluation/evaluation.h"
#include "estimation/model/model.h"

namespace hookeye {

/// One example's derivative columns at fixed q.
struct ExampleColumns {
  Eigen::MatrixXd dR;                   ///< 3n x m [force / parameter]
  Eigen::MatrixXd dqc;                  ///< prescribed unknowns x m
  std::vector<Eigen::MatrixXd> dphoto;  ///< per photo kPhotoNumbers x m
  Eigen::Matrix3Xd d_offset;            ///< 3 x m, force_offset
  /// d(placement x) at fixed x for position measurements: 12 x m (linear column by column, then
  /// translation).
  Eigen::MatrixXd d_placement;
  Eigen::MatrixXd d_calibration;  ///< Model::calibration x m
};

/// Weights of the realised neighbours of a central or one-sided difference (at most 3).
struct Stencil {
  std::vector<double> shift, weight;
};

/// All realised neighbours of all columns are built once and shared by the examples.
class ColumnSet {
 public:
  ColumnSet(const ModelForm& form, const VectorXd& p,
            const std::vector<std::shared_ptr<const Ingredient>>& candidates);
  int size() const { return static_cast<int>(columns_.size()); }
  ExampleColumns of_example(const Model& model, int example, const Equilibrium& equilibrium) const;

 private:
  struct Column {
    const Ingredient* ingredient;
    int local;  ///< parameter inside the ingredient
    VectorXd values;
    Touches touches;
    Stencil stencil;
    std::vector<Model> neighbours;
  };
  std::vector<Column> columns_;
  std::vector<std::shared_ptr<const ModelForm>> forms_;
  void add(std::shared_ptr<const ModelForm> form, const VectorXd& p, size_t ingredient);
};

}  // namespace hookeye
