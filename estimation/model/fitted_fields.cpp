#include "estimation/model/fitted_fields.h"

namespace hookeye {
namespace {

/// Sum of the weights of the capture's materials, one an element.
VectorXd material_weight(const Model& model) {
  const int n = model.scene->body->mesh.size();
  VectorXd sum = VectorXd::Zero(n);
  for (size_t i = 0; i < model.scene->capture.materials.size(); ++i) {
    const VectorXd& weight = model.energy.parts.at(i).weight;
    sum += weight.size() ? weight : VectorXd::Ones(n);
  }
  return sum;
}

}  // namespace

std::map<std::string, VectorXd> fitted_fields(const ModelForm& form, const Model& realised) {
  std::map<std::string, VectorXd> out;
  const VectorXd factor = material_weight(realised).cwiseQuotient(material_weight(form.start));
  if ((factor.array() != 1.0).any()) out["stiffness"] = factor.array() - 1.0;
  if (realised.energy.swelling.size()) out["swelling"] = realised.energy.swelling.array() - 1.0;
  return out;
}

}  // namespace hookeye
