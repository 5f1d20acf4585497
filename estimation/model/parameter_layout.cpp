#include "estimation/model/parameter_layout.h"

#include "estimation/model/model.h"

namespace hookeye {

ParameterLayout::ParameterLayout(
    const std::vector<std::shared_ptr<const Ingredient>>& ingredients) {
  Eigen::Index first = 0;
  for (const auto& one : ingredients) {
    blocks_.push_back({first, static_cast<Eigen::Index>(one->parameters().size())});
    first += blocks_.back().size;
  }
}

Eigen::Index ParameterLayout::size() const {
  return blocks_.empty() ? 0 : blocks_.back().first + blocks_.back().size;
}

Eigen::VectorXd ParameterLayout::of(const Eigen::VectorXd& p, size_t ingredient) const {
  const Block& block = (*this)[ingredient];
  return p.segment(block.first, block.size);
}

Eigen::VectorXd ParameterLayout::before(const Eigen::VectorXd& p, size_t ingredient) const {
  return p.head((*this)[ingredient].first);
}

Eigen::VectorXd ParameterLayout::with(const Eigen::VectorXd& p, size_t ingredient,
                                      const Eigen::VectorXd& values) const {
  const Block& block = (*this)[ingredient];
  Eigen::VectorXd out(p.size() - block.size + values.size());
  out << p.head(block.first), values, p.tail(p.size() - block.first - block.size);
  return out;
}

}  // namespace hookeye
