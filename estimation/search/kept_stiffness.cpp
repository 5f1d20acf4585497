#include "estimation/search/kept_stiffness.h"

#include <algorithm>
#include <vector>

#include "estimation/evaluation/normal_equations.h"

namespace hookeye {

namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

VectorXd with_stiffness_of(const Model& model, const ModelForm& form, VectorXd p) {
  const Model there = form.realise(p);
  const auto elements = model.scene->body->mesh.size();
  if (model.energy.parts.empty() || there.energy.parts.empty() ||
      there.scene->body->mesh.size() != elements)
    return p;
  const auto weight = [](const Model& of, Eigen::Index e) {
    const VectorXd& all = of.energy.parts.front().weight;
    return all.size() ? all[e] : 1.0;
  };
  std::vector<double> ratio;  // where the law is: other groups of elements may follow another
  for (Eigen::Index e = 0; e < elements; ++e)
    if (weight(model, e) > 0.0 && weight(there, e) > 0.0)
      ratio.push_back(weight(model, e) / weight(there, e));
  if (ratio.empty()) return p;
  const double factor = median(std::move(ratio));
  const auto parameters = form.parameters();
  for (Eigen::Index i = 0; i < p.size(); ++i)
    if (const Parameter& one = parameters[static_cast<size_t>(i)]; is_modulus(one))
      p[i] = std::clamp(factor * p[i], one.low, one.high);
  return p;
}

}  // namespace hookeye
