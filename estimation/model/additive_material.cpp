#include "estimation/model/additive_material.h"

#include <fmt/format.h>

#include <mutex>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "estimation/model/additive_function.h"
#include "simulation/equilibrium.h"
#include "simulation/laws/material_frame.h"

namespace hookeye {
namespace {

using nlohmann::json;

std::vector<double> numbers(const auto& matrix) {
  return {matrix.data(), matrix.data() + matrix.size()};
}

/// Structure as text. Values of free addends stand among the parameters.
std::string to_text(const AdditiveModel& model, const MaterialPlace& place) {
  json out = {{"additive", 1}};
  if (!place.label.empty()) out["material"] = {place.part, place.label};
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

std::pair<AdditiveModel, MaterialPlace> from_text(const std::string& text) {
  const json in = json::parse(text, nullptr, false);
  if (!in.is_object() || !in.contains("additive"))
    throw std::invalid_argument("not an additive material");
  try {
    AdditiveModel model;
    MaterialPlace place;
    if (in.contains("material"))
      place = {in["material"].at(0).get<int>(), in["material"].at(1).get<std::string>()};
    if (place.part < 0) throw std::invalid_argument("no such material");
    if (in.contains("frame")) model.frame = vector_of<9>(in["frame"]).reshaped(3, 3);
    if (in.contains("axis"))
      model.cylinder = {vector_of<3>(in["axis"]), vector_of<3>(in.at("center"))};
    if (in.contains("barrier")) {
      model.barrier_modulus = in["barrier"].at(0).get<double>();
      model.barrier_below = in["barrier"].at(1).get<double>();
    }
    for (const json& one : in.at("addends")) read_addend(one, model);
    if (const auto wrong = structure_fault(model)) throw std::invalid_argument(wrong->wrong);
    return {std::move(model), std::move(place)};
  } catch (const json::exception& error) {
    throw std::invalid_argument(error.what());
  }
}

std::vector<Parameter> named(std::vector<Parameter> all, const std::string& label) {
  if (!label.empty())
    for (Parameter& one : all) one.name = label + "." + one.name;
  return all;
}

class AdditiveMaterial final : public Ingredient {
 public:
  AdditiveMaterial(AdditiveModel model, const Units& units, MaterialPlace place)
      : model_(std::move(model)),
        place_(std::move(place)),
        variant_(to_text(model_, place_)),
        parameters_(named(additive(model_)->parameters(units), place_.label)) {}
  const AdditiveModel& model() const { return model_; }
  const MaterialPlace& place() const { return place_; }

  std::string name() const override { return "material"; }
  std::string variant() const override { return variant_; }
  std::vector<Parameter> parameters() const override { return parameters_; }
  Touches touches() const override { return {.energy = true}; }
  void apply(const VectorXd& values, Model& model) const override {
    AdditiveModel own = model_;
    own.set_values(values);
    EnergyModel::Part& part = model.energy.parts.at(index());
    part.term = additive(own);
    set_frames(part, model.scene->body->mesh);
  }
  bool mechanics_derivative(const VectorXd&, const Model& model, int example,
                            const Equilibrium& equilibrium, int parameter,
                            MechanicsDerivative& out) const override {
    const std::lock_guard lock(mutex_);
    Columns& kept = columns_[example];
    const EnergyModel::Part& part = model.energy.parts.at(index());
    // Forces are linear in the values: the columns depend on q and on the factors alone.
    const EnergyModel scaled = model.energy_of(example);
    const VectorXd& weight = scaled.parts[index()].weight;
    if (kept.q.size() != equilibrium.q.size() || kept.q != equilibrium.q ||
        kept.weight.size() != weight.size() || kept.weight != weight ||
        kept.swelling.size() != scaled.swelling.size() || kept.swelling != scaled.swelling) {
      if (static_cast<size_t>(part.term->size()) != parameters_.size()) return false;
      kept = {equilibrium.q, weight, scaled.swelling,
              all_dR_dtheta(model.scene->body->mesh, scaled, equilibrium.q, place_.part)};
    }
    out.dR_dt = kept.dR.col(parameter);
    return true;
  }

 private:
  struct Columns {
    VectorXd q, weight, swelling;
    Eigen::MatrixXd dR;
  };
  size_t index() const { return static_cast<size_t>(place_.part); }
  AdditiveModel model_;
  MaterialPlace place_;
  std::string variant_;
  std::vector<Parameter> parameters_;
  mutable std::mutex mutex_;
  mutable std::map<int, Columns> columns_;
};

}  // namespace

std::shared_ptr<const Ingredient> additive_material(const AdditiveModel& model, const Units& units,
                                                    const MaterialPlace& place) {
  return std::make_shared<AdditiveMaterial>(model, units, place);
}

std::shared_ptr<const Ingredient> additive_material_from(const std::string& variant,
                                                         const Units& units) {
  const auto [model, place] = from_text(variant);
  return additive_material(model, units, place);
}

namespace {

/// Calls visit(ingredient, its index, offset of its values, their number).
template <class Visit>
void for_each_ingredient(const ModelForm& form, Visit&& visit) {
  const ParameterLayout at = form.layout();
  for (size_t i = 0; i < form.ingredients.size(); ++i)
    visit(*form.ingredients[i], static_cast<int>(i), static_cast<int>(at[i].first),
          static_cast<int>(at[i].size));
}

const AdditiveMaterial* as_material(const Ingredient& ingredient) {
  return dynamic_cast<const AdditiveMaterial*>(&ingredient);
}

}  // namespace

bool fits_capture(const Ingredient& additive_material, const Capture& capture) {
  const AdditiveMaterial* own = as_material(additive_material);
  if (!own || own->place().part >= static_cast<int>(capture.materials.size())) return false;
  // a material alone needs no name
  return capture.materials.size() == 1 ||
         capture.materials[static_cast<size_t>(own->place().part)].region == own->place().label;
}

std::vector<AdditivePart> additive_parts(const ModelForm& form, const VectorXd& p) {
  std::vector<AdditivePart> out;
  for_each_ingredient(form, [&](const Ingredient& one, int, int offset, int n) {
    const AdditiveMaterial* material = as_material(one);
    if (!material) return;
    out.push_back({offset, material->place(), material->model()});
    out.back().model.set_values(p.segment(offset, n));
  });
  return out;
}

bool has_additive(const ModelForm& form) {
  return std::any_of(form.ingredients.begin(), form.ingredients.end(),
                     [](const auto& one) { return as_material(*one) != nullptr; });
}

bool has_additive(const Model& model) {
  const auto& parts = model.energy.parts;
  const auto told = static_cast<std::ptrdiff_t>(model.scene->capture.materials.size());
  return std::any_of(parts.begin(), parts.begin() + told,
                     [](const auto& part) { return additive_model(*part.term) != nullptr; });
}

std::vector<AddedPart> added_parts(const ModelForm& form, const VectorXd& p) {
  std::vector<AddedPart> out;
  for_each_ingredient(form, [&](const Ingredient& one, int, int offset, int n) {
    auto added = added_functions(one, p.segment(offset, n));
    if (!added) return;
    Eigen::MatrixXd by_p = Eigen::MatrixXd::Zero(added->by_values.rows(), p.size());
    by_p.middleCols(offset, n) = added->by_values;
    out.push_back({one.name(), {std::move(added->model), std::move(by_p)}});
  });
  return out;
}

namespace {

/// Adds `functions` to every part of the same frame; false: there is none.
bool add_to_each(std::vector<ConvexPart>& parts, const ConvexPart& functions) {
  bool any = false;
  for (ConvexPart& part : parts) {
    auto sum = sum_of(part.model, functions.model);
    if (!sum) continue;
    Eigen::MatrixXd by_x(part.by_x.rows() + functions.by_x.rows(), functions.by_x.cols());
    by_x << part.by_x, functions.by_x;
    part = {std::move(*sum), std::move(by_x)};
    any = true;
  }
  return any;
}

}  // namespace

std::vector<ConvexPart> convex_parts(const ModelForm& form, const VectorXd& p) {
  std::vector<ConvexPart> out;
  for (const AdditivePart& part : additive_parts(form, p)) {
    const int n = part.model.size();
    Eigen::MatrixXd by_p = Eigen::MatrixXd::Zero(n, p.size());
    by_p.middleCols(part.offset, n).setIdentity();
    out.push_back({part.model, std::move(by_p)});
  }
  std::vector<ConvexPart> alone;
  for (const AddedPart& added : added_parts(form, p))
    if (!add_to_each(out, added.functions)) alone.push_back(added.functions);
  out.insert(out.end(), alone.begin(), alone.end());
  return out;
}

namespace {

/// The law's energy and axes.
AdditiveModel start_of(const EnergyTerm& law, const MaterialSpec& told) {
  const Matrix9d D = law.dP_dF(Matrix3d::Identity());
  const double mu = 0.5 * (D(1, 1) + D(1, 3)), kappa = D(0, 4) + 2.0 / 3.0 * mu;
  auto exact = as_additive(law);
  AdditiveModel model = exact ? *exact : additive_neo_hookean(mu, kappa);
  if (const CylinderFrame* cylinder = law.cylinder()) model.cylinder = *cylinder;
  if (const auto frame = told.parameters.find("frame"); !exact && frame != told.parameters.end())
    model.frame = laws::read_frame(frame->second);
  if (model.barrier_modulus == 0) {
    model.barrier_modulus = std::max(kappa, mu);
    model.barrier_below = 0.3;
  }
  return model;
}

}  // namespace

std::pair<ModelForm, VectorXd> to_additive(const ModelForm& form, const VectorXd& p) {
  const Capture& capture = form.scene->capture;
  ModelForm out = form;
  std::vector<double> values;
  const Model now = form.realise(p);
  out.ingredients.clear();
  for (size_t i = 0; i < capture.materials.size(); ++i) {
    const AdditiveModel model = start_of(*now.energy.parts[i].term, capture.materials[i]);
    out.ingredients.push_back(additive_material(
        model, capture.units, {static_cast<int>(i), capture.materials[i].region}));
    const VectorXd start = model.values();
    values.insert(values.end(), start.begin(), start.end());
  }
  for_each_ingredient(form, [&](const Ingredient& one, int index, int offset, int n) {
    if (one.name() == "material") return;
    out.ingredients.push_back(form.ingredients[static_cast<size_t>(index)]);
    values.insert(values.end(), p.data() + offset, p.data() + offset + n);
  });
  return {out, Eigen::Map<const VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()))};
}

std::pair<ModelForm, VectorXd> with_structures(const ModelForm& form, const VectorXd& p,
                                               const std::vector<AdditiveModel>& models) {
  ModelForm out = form;
  std::vector<double> values;
  size_t next = 0;
  for_each_ingredient(form, [&](const Ingredient& one, int index, int offset, int n) {
    VectorXd own = p.segment(offset, n);
    if (const AdditiveMaterial* material = as_material(one)) {
      const AdditiveModel& model = models.at(next++);
      out.ingredients[static_cast<size_t>(index)] =
          additive_material(model, form.scene->capture.units, material->place());
      own = model.values();
    }
    values.insert(values.end(), own.begin(), own.end());
  });
  if (next != models.size()) throw std::logic_error("with_structures: one for every material");
  return {out, Eigen::Map<const VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()))};
}

std::optional<ConvexityTest> smallest_eigenvalue(const Model& model) {
  std::vector<ConvexPart> materials, added;
  const size_t told = model.scene->capture.materials.size();
  for (size_t i = 0; i < model.energy.parts.size(); ++i)
    if (const AdditiveModel* own = additive_model(*model.energy.parts[i].term))
      (i < told ? materials : added).push_back({*own, Eigen::MatrixXd(own->size(), 0)});
  std::vector<ConvexPart> all = materials;
  for (const ConvexPart& one : added)
    if (!add_to_each(all, one)) all.push_back(one);
  std::optional<ConvexityTest> least;
  for (const ConvexPart& one : all) {
    ConvexityTest test = smallest_eigenvalue(one.model);
    if (!least || test.smallest < least->smallest) least = std::move(test);
  }
  return least;
}

std::optional<NumericalFailure> not_convex(const Model& model) {
  const auto test = smallest_eigenvalue(model);
  double stiffest = 0.0;
  for (const EnergyModel::Part& part : model.energy.parts)
    if (const AdditiveModel* own = additive_model(*part.term); own && own->size() > 0)
      stiffest = std::max(stiffest, own->values().cwiseAbs().maxCoeff());
  if (!test || test->smallest >= -1e-12 * stiffest) return {};
  return NumericalFailure{"", 0.0, fmt::format("the energy is not convex at {}", test->where)};
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
