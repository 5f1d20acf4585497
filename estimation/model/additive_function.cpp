#include "estimation/model/additive_function.h"

#include "estimation/model/additive_material.h"
#include "simulation/equilibrium.h"

namespace hookeye {
namespace {

class AdditiveFunction final : public Ingredient {
 public:
  explicit AdditiveFunction(FunctionSpec spec) : spec_(std::move(spec)) {}
  std::string name() const override { return spec_.name; }
  std::string variant() const override { return spec_.variant; }
  std::vector<Parameter> parameters() const override { return spec_.parameters; }
  Touches touches() const override { return {.energy = true}; }
  std::shared_ptr<const Ingredient> with_bounds(
      const std::vector<std::pair<double, double>>& bounds) const override {
    auto out = std::make_shared<AdditiveFunction>(spec_);
    set_bounds(out->spec_.parameters, bounds);
    return out;
  }
  void apply(const VectorXd& values, Model& model) const override {
    if (!values.isZero(0.0)) model.energy.parts.push_back(part_of(spec_.functions(values), model));
  }
  bool mechanics_derivative(const VectorXd& values, const Model& model, int example,
                            const Equilibrium& equilibrium, int parameter,
                            MechanicsDerivative& out) const override {
    // Once it is in, effects added later may weigh its part; and at zero a direction has no slope.
    if (!values.isZero(0.0)) return false;
    const AddedFunctions added = at(values);
    AdditiveModel slope = added.model;
    slope.set_values(added.by_values.col(parameter));
    EnergyModel alone;
    alone.swelling = model.energy.swelling;
    alone.parts.push_back(part_of(slope, model));
    const TetMesh& mesh = model.scene->body->mesh;
    out.dR_dt = model.examples[example].stiffness * residual(mesh, alone, Loading{}, equilibrium.q);
    return true;
  }
  AddedFunctions at(const VectorXd& values) const {
    AddedFunctions out{spec_.functions(values), {}};
    const VectorXd here = out.model.values();
    out.by_values.resize(here.size(), values.size());
    for (Eigen::Index k = 0; k < values.size(); ++k) {
      // of the size of the values, so that differences of linear functions stay exact to rounding
      const double step = spec_.parameters[static_cast<size_t>(k)].typical;
      VectorXd moved = values;
      moved[k] += step;
      out.by_values.col(k) = (spec_.functions(moved).values() - here) / step;
    }
    return out;
  }

 private:
  EnergyModel::Part part_of(const AdditiveModel& functions, const Model& model) const {
    EnergyModel::Part part{additive(functions), {}, {}};
    if (spec_.like_part >= 0)
      part.weight = model.energy.parts.at(static_cast<size_t>(spec_.like_part)).weight;
    set_frames(part, model.scene->body->mesh);
    return part;
  }
  FunctionSpec spec_;
};

}  // namespace

std::shared_ptr<const Ingredient> additive_function(FunctionSpec spec) {
  return std::make_shared<AdditiveFunction>(std::move(spec));
}

std::optional<AddedFunctions> added_functions(const Ingredient& ingredient,
                                              const VectorXd& values) {
  const auto* found = dynamic_cast<const AdditiveFunction*>(&ingredient);
  return found ? std::optional(found->at(values)) : std::nullopt;
}

}  // namespace hookeye
