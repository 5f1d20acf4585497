// Where the numbers of a model's ingredients stand in its vector of parameters.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace hookeye {

class Ingredient;

/// One block of p an ingredient, in their order. Indices are the ingredients'; p has size().
class ParameterLayout {
 public:
  struct Block {
    Eigen::Index first = 0, size = 0;
  };

  explicit ParameterLayout(const std::vector<std::shared_ptr<const Ingredient>>& ingredients);

  const Block& operator[](size_t ingredient) const { return blocks_.at(ingredient); }
  size_t last() const { return blocks_.size() - 1; }
  Eigen::Index size() const;

  /// The ingredient's numbers, and those of all before it.
  Eigen::VectorXd of(const Eigen::VectorXd& p, size_t ingredient) const;
  Eigen::VectorXd before(const Eigen::VectorXd& p, size_t ingredient) const;
  /// p with `values`, few or many, in the place of the ingredient's numbers.
  Eigen::VectorXd with(const Eigen::VectorXd& p, size_t ingredient,
                       const Eigen::VectorXd& values) const;
  Eigen::VectorXd without(const Eigen::VectorXd& p, size_t ingredient) const {
    return with(p, ingredient, {});
  }

 private:
  std::vector<Block> blocks_;
};

}  // namespace hookeye
