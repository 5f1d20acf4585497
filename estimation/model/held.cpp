#include "estimation/model/held.h"

#include <fmt/format.h>

#include <charconv>
#include <sstream>
#include <stdexcept>

namespace hookeye {
namespace {

constexpr const char* kHolds = "holds";

class Held : public Ingredient {
 public:
  Held(std::shared_ptr<const Ingredient> whole, const std::map<std::string, double>& told)
      : whole_(std::move(whole)), told_(told) {
    const auto all = whole_->parameters();
    values_ = VectorXd(all.size());
    for (size_t i = 0; i < all.size(); ++i) {
      const auto found = told.find(all[i].name);
      const auto at = static_cast<Eigen::Index>(i);
      if (found == told.end())
        free_.push_back(static_cast<int>(i)), values_[at] = all[i].value;
      else
        values_[at] = found->second;
    }
    if (free_.size() + told.size() != all.size())
      throw std::invalid_argument(whole_->name() + " has no such parameter");
  }

  std::string name() const override { return whole_->name(); }
  std::string variant() const override {
    std::string out = kHolds;
    for (const auto& [name, value] : told_) out += fmt::format(" {}={:.17g}", name, value);
    return out;
  }
  std::vector<Parameter> parameters() const override {
    const auto all = whole_->parameters();
    std::vector<Parameter> out;
    for (const int i : free_) out.push_back(all[static_cast<size_t>(i)]);
    return out;
  }
  Touches touches() const override { return whole_->touches(); }
  void apply(const VectorXd& values, Model& model) const override {
    whole_->apply(all_values(values), model);
  }
  bool mechanics_derivative(const VectorXd& values, const Model& model, int example,
                            const Equilibrium& equilibrium, int parameter,
                            MechanicsDerivative& out) const override {
    return whole_->mechanics_derivative(all_values(values), model, example, equilibrium,
                                        free_[static_cast<size_t>(parameter)], out);
  }

 private:
  VectorXd all_values(const VectorXd& free) const {
    VectorXd all = values_;
    for (size_t i = 0; i < free_.size(); ++i) all[free_[i]] = free[static_cast<Eigen::Index>(i)];
    return all;
  }

  std::shared_ptr<const Ingredient> whole_;
  std::map<std::string, double> told_;
  std::vector<int> free_;  ///< indices into the whole's parameters
  VectorXd values_;        ///< of all of them
};

}  // namespace

std::shared_ptr<const Ingredient> hold(std::shared_ptr<const Ingredient> whole,
                                       const std::map<std::string, double>& told) {
  if (!whole->variant().empty())
    throw std::invalid_argument(whole->name() + " has a form of its own, which cannot be held");
  return std::make_shared<Held>(std::move(whole), told);
}

std::optional<std::map<std::string, double>> held_in(const std::string& variant) {
  std::istringstream words(variant);
  std::string word;
  if (!(words >> word) || word != kHolds) return {};
  std::map<std::string, double> told;
  while (words >> word) {
    const size_t equals = word.find('=');
    double value = 0.0;
    const char* const end = word.data() + word.size();
    if (equals == std::string::npos ||
        std::from_chars(word.data() + equals + 1, end, value).ptr != end)
      return {};
    told[word.substr(0, equals)] = value;
  }
  return told;
}

}  // namespace hookeye
