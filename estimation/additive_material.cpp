#include "estimation/additive_material.h"

#include <fmt/format.h>

#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "capture_io/input_error.h"
#include "simulation/equilibrium.h"

namespace hookeye {
namespace {

using nlohmann::json;

std::vector<double> numbers(const auto& matrix) {
  return {matrix.data(), matrix.data() + matrix.size()};
}

/// Structure as text. Values of free addends stand among the parameters.
std::string to_text(const AdditiveModel& model) {
  json out = {{"additive", 1}};
  if (!model.frame.isIdentity(0.0)) out["frame"] = numbers(model.frame);
  if (model.cylinder) {
    out["axis"] = numbers(model.cylinder->axis);
    out["center"] = numbers(model.cylinder->center);
  }
  if (model.barrier_modulus > 0) out["barrier"] = {model.barrier_modulus, model.barrier_below};
  for (const Addend& a : model.addends) {
    json one = {{"name", a.name}, {"at", a.at}};
    if (a.second >= 0) one["at_2"] = a.at_second;
    if (a.fixed) one["stiffness"] = numbers(a.stiffness);
    for (int c : {a.first, a.second})
      if (c >= 0 && model.components[c].kind == StrainComponent::Kind::fibre)
        one["direction"][model.components[c].name] = numbers(model.components[c].direction);
    out["addends"].push_back(std::move(one));
  }
  return out.dump();
}

template <int N>
Eigen::Matrix<double, N, 1> vector_of(const json& list) {
  const auto values = list.get<std::vector<double>>();
  if (values.size() != N) throw std::invalid_argument("wrong number of numbers");
  return Eigen::Map<const Eigen::Matrix<double, N, 1>>(values.data());
}

void read_addend(const json& one, AdditiveModel& model) {
  const auto name = one.at("name").get<std::string>();
  const auto at = one.at("at").get<std::vector<double>>();
  const auto at_2 = one.value("at_2", std::vector<double>{});
  const bool fixed = one.contains("stiffness");
  const auto size = static_cast<Eigen::Index>(at.size() * (at_2.empty() ? 1 : at_2.size()));
  VectorXd values = VectorXd::Zero(size);
  if (fixed) {
    const auto told = one.at("stiffness").get<std::vector<double>>();
    values = Eigen::Map<const VectorXd>(told.data(), static_cast<Eigen::Index>(told.size()));
  }
  const std::string components = fixed ? name.substr(0, name.find('.')) : name;
  add_addend(model, components, at, at_2, values);
  model.addends.back().name = name;
  model.addends.back().fixed = fixed;
  if (one.contains("direction"))
    for (const auto& [fibre, d] : one.at("direction").items())
      model.components[component_index(model, fibre)].direction = vector_of<3>(d);
}

AdditiveModel from_text(const std::string& text) {
  const json in = json::parse(text, nullptr, false);
  if (!in.is_object() || !in.contains("additive"))
    throw std::invalid_argument("not an additive material");
  try {
    AdditiveModel model;
    if (in.contains("frame")) model.frame = vector_of<9>(in["frame"]).reshaped(3, 3);
    if (in.contains("axis"))
      model.cylinder = {vector_of<3>(in["axis"]), vector_of<3>(in.at("center"))};
    if (in.contains("barrier")) {
      model.barrier_modulus = in["barrier"].at(0).get<double>();
      model.barrier_below = in["barrier"].at(1).get<double>();
    }
    for (const json& one : in.at("addends")) read_addend(one, model);
    if (const auto wrong = structure_fault(model)) throw std::invalid_argument(wrong->wrong);
    return model;
  } catch (const json::exception& error) {
    throw std::invalid_argument(error.what());
  }
}

class AdditiveMaterial final : public Ingredient {
 public:
  AdditiveMaterial(AdditiveModel model, const Units& units)
      : model_(std::move(model)),
        variant_(to_text(model_)),
        parameters_(additive(model_)->parameters(units)) {}
  const AdditiveModel& model() const { return model_; }

  std::string name() const override { return "material"; }
  std::string variant() const override { return variant_; }
  std::vector<Parameter> parameters() const override { return parameters_; }
  Touches touches() const override { return {.energy = true}; }
  void apply(const VectorXd& values, Model& model) const override {
    AdditiveModel own = model_;
    own.set_values(values);
    EnergyModel::Part& part = model.energy.parts.at(0);
    part.term = additive(own);
    set_frames(part, model.scene->body->mesh);
  }
  bool mechanics_derivative(const VectorXd&, const Model& model, int example,
                            const Equilibrium& equilibrium, int parameter,
                            MechanicsDerivative& out) const override {
    const std::lock_guard lock(mutex_);
    Columns& kept = columns_[example];
    const EnergyModel::Part& part = model.energy.parts.at(0);
    // Forces are linear in the values: the columns depend on q and on the factors alone.
    const EnergyModel scaled = model.energy_of(example);
    if (kept.q.size() != equilibrium.q.size() || kept.q != equilibrium.q ||
        kept.weight.size() != scaled.parts[0].weight.size() ||
        kept.weight != scaled.parts[0].weight || kept.swelling.size() != scaled.swelling.size() ||
        kept.swelling != scaled.swelling) {
      if (static_cast<size_t>(part.term->size()) != parameters_.size()) return false;
      kept = {equilibrium.q, scaled.parts[0].weight, scaled.swelling,
              all_dR_dtheta(model.scene->body->mesh, scaled, equilibrium.q, 0)};
    }
    out.dR_dt = kept.dR.col(parameter);
    return true;
  }

 private:
  struct Columns {
    VectorXd q, weight, swelling;
    Eigen::MatrixXd dR;
  };
  AdditiveModel model_;
  std::string variant_;
  std::vector<Parameter> parameters_;
  mutable std::mutex mutex_;
  mutable std::map<int, Columns> columns_;
};

}  // namespace

std::shared_ptr<const Ingredient> additive_material(const AdditiveModel& model,
                                                    const Units& units) {
  return std::make_shared<AdditiveMaterial>(model, units);
}

const AdditiveModel* additive_structure(const Ingredient& ingredient) {
  const auto* found = dynamic_cast<const AdditiveMaterial*>(&ingredient);
  return found ? &found->model() : nullptr;
}

std::shared_ptr<const Ingredient> additive_material_from(const std::string& variant,
                                                         const Units& units) {
  const AdditiveModel model = from_text(variant);
  return additive_material(model, units);
}

AdditivePart find_additive(const ModelForm& form, const VectorXd& p) {
  AdditivePart out;
  int offset = 0;
  for (size_t i = 0; i < form.ingredients.size(); ++i) {
    const AdditiveModel* model = additive_structure(*form.ingredients[i]);
    if (model) {
      out.ingredient = static_cast<int>(i);
      out.offset = offset;
      out.model = *model;
      out.model.set_values(p.segment(offset, model->size()));
      return out;
    }
    offset += static_cast<int>(form.ingredients[i]->parameters().size());
  }
  return out;
}

namespace {

AdditiveModel start_of(const EnergyTerm& law) {
  const Matrix9d D = law.dP_dF(Matrix3d::Identity());
  const double mu = 0.5 * (D(1, 1) + D(1, 3)), kappa = D(0, 4) + 2.0 / 3.0 * mu;
  auto exact = as_additive(law);
  AdditiveModel model = exact ? *exact : additive_neo_hookean(mu, kappa);
  if (const CylinderFrame* cylinder = law.cylinder()) model.cylinder = *cylinder;
  if (model.barrier_modulus == 0) {
    model.barrier_modulus = std::max(kappa, mu);
    model.barrier_below = 0.3;
  }
  return model;
}

}  // namespace

std::pair<ModelForm, VectorXd> to_additive(const ModelForm& form, const VectorXd& p) {
  const Capture& capture = form.scene->capture;
  if (capture.materials.size() != 1)
    throw InputError(
        capture.materials.empty() ? Place{capture.file.string()} : capture.materials[1].place,
        "the additive material is fitted for one material over the whole body",
        "tell one `material`, or fit the laws of the regions");
  ModelForm out = form;
  std::vector<double> values;
  const Model now = form.realise(p);
  const AdditiveModel model = start_of(*now.energy.parts[0].term);
  const auto material = additive_material(model, capture.units);
  out.ingredients.assign(1, material);
  const VectorXd start = model.values();
  values.assign(start.data(), start.data() + start.size());
  int offset = 0;
  for (const auto& ingredient : form.ingredients) {
    const int n = static_cast<int>(ingredient->parameters().size());
    if (ingredient->name() != "material") {
      out.ingredients.push_back(ingredient);
      values.insert(values.end(), p.data() + offset, p.data() + offset + n);
    }
    offset += n;
  }
  return {out, Eigen::Map<const VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()))};
}

std::pair<ModelForm, VectorXd> with_structure(const ModelForm& form, const VectorXd& p,
                                              const AdditiveModel& model) {
  const AdditivePart old = find_additive(form, p);
  if (old.ingredient < 0) throw std::logic_error("with_structure: no additive material");
  ModelForm out = form;
  out.ingredients[old.ingredient] = additive_material(model, form.scene->capture.units);
  const int before = old.offset, after = static_cast<int>(p.size()) - before - old.model.size();
  VectorXd values(before + model.size() + after);
  values << p.head(before), model.values(), p.tail(after);
  return {out, values};
}

std::optional<NumericalFailure> not_convex(const Model& model) {
  for (const EnergyModel::Part& part : model.energy.parts) {
    const AdditiveModel* additive = additive_model(*part.term);
    if (!additive) continue;
    const ConvexityTest test = smallest_eigenvalue(*additive);
    if (test.smallest < -1e-12 * additive->values().cwiseAbs().maxCoeff())
      return NumericalFailure{"", 0.0, fmt::format("the energy is not convex at {}", test.where)};
  }
  return {};
}

void set_frames(EnergyModel::Part& part, const TetMesh& mesh) {
  const CylinderFrame* cylinder = part.term->cylinder();
  if (!cylinder || part.frames.cols() == mesh.size()) return;
  Matrix3Xd centroids = Matrix3Xd::Zero(3, mesh.size());
  for (int e = 0; e < mesh.size(); ++e)
    for (int a = 0; a < 4; ++a) centroids.col(e) += 0.25 * mesh.X.col(mesh.elements(a, e));
  part.frames = cylinder_frames(*cylinder, centroids);
}

}  // namespace hookeye
