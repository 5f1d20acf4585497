#include "estimation/kept_stiffness.h"

#include <algorithm>
#include <cmath>

#include "estimation/normal_equations.h"

namespace hookeye {

namespace {

/// Of the base law, by element; empty: the same everywhere.
const VectorXd& weights(const Model& model) { return model.energy.parts.front().weight; }

double median(VectorXd values) {
  double* middle = values.data() + values.size() / 2;
  std::nth_element(values.data(), middle, values.data() + values.size());
  return *middle;
}

}  // namespace

VectorXd with_stiffness_of(const Model& model, const ModelForm& form, VectorXd p) {
  const Model there = form.realise(p);
  const auto elements = model.scene->body->mesh.size();
  if (model.energy.parts.empty() || there.energy.parts.empty() ||
      there.scene->body->mesh.size() != elements)
    return p;
  VectorXd log_ratio = VectorXd::Zero(elements);
  if (weights(model).size()) log_ratio += weights(model).array().log().matrix();
  if (weights(there).size()) log_ratio -= weights(there).array().log().matrix();
  const double factor = std::exp(median(log_ratio));
  const auto parameters = form.parameters();
  for (Eigen::Index i = 0; i < p.size(); ++i)
    if (const Parameter& one = parameters[static_cast<size_t>(i)]; is_modulus(one))
      p[i] = std::clamp(factor * p[i], one.low, one.high);
  return p;
}

}  // namespace hookeye
