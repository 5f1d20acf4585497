// Where an additive material may need one function more.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimation/additive_material.h"
#include "estimation/effects/toolbox.h"
#include "estimation/energy_curves.h"
#include "estimation/progressive.h"

namespace hookeye {
namespace {

/// Term with one addend alone: at its null 0.
AdditiveModel alone(const AdditiveModel& like, const std::string& name, std::vector<double> at,
                    const VectorXd& values) {
  AdditiveModel one;
  one.frame = like.frame;
  one.cylinder = like.cylinder;
  std::vector<double> at_second;
  if (name.find('_') != std::string::npos) at_second = {0.0};
  add_addend(one, name, std::move(at), at_second, values);
  for (StrainComponent& c : one.components)
    for (const StrainComponent& known : like.components)
      if (known.name == c.name) c.direction = known.direction;
  return one;
}

std::shared_ptr<const Ingredient> candidate_of(const AdditiveModel& function, bool one_sided,
                                               double typical, const std::string& what) {
  IngredientSpec spec;
  spec.name = what;
  Parameter t;
  t.name = "t";
  t.typical = typical;
  if (one_sided) t.low = 0.0;
  spec.parameters = {t};
  spec.touches = {.energy = true};
  const auto part_of = [function](double t, const Model& model) {
    AdditiveModel scaled = function;
    scaled.set_values(t * function.values());
    EnergyModel::Part part{additive(scaled), {}, {}};
    set_frames(part, model.scene->body->mesh);
    return part;
  };
  spec.apply = [part_of](const VectorXd& values, Model& model) {
    model.energy.parts.push_back(part_of(values[0], model));
  };
  spec.derivative = [part_of](const VectorXd&, const Model& model, int example,
                              const Equilibrium& equilibrium, int, MechanicsDerivative& out) {
    EnergyModel energy;
    energy.parts.push_back(part_of(1.0, model));
    energy.swelling = model.energy.swelling;
    const TetMesh& mesh = model.scene->body->mesh;
    if (model.examples[example].stiffness != 1.0)
      energy.parts[0].weight = VectorXd::Constant(mesh.size(), model.examples[example].stiffness);
    out.dR_dt = residual(mesh, energy, Loading{}, equilibrium.q);
    return true;
  };
  return make_ingredient(std::move(spec));
}

/// Rounded so that files and sentences show the very control point.
double round_strain(double e) { return std::stod(fmt::format("{:.3g}", e)) + 0.0; }

/// Ends of the visited range and middles of the intervals in it, where there is no point yet.
std::vector<double> new_points(const Addend& a, double low, double high) {
  if (a.even) high = std::max(high, -low), low = 0.0;
  std::vector<double> marks = {low, high};
  for (double x : a.at)
    if (x > low && x < high) marks.push_back(x);
  std::sort(marks.begin(), marks.end());
  std::vector<double> wanted = {low, high};
  for (size_t i = 0; i + 1 < marks.size(); ++i) wanted.push_back(0.5 * (marks[i] + marks[i + 1]));
  std::vector<double> out;
  const double apart = 0.05 * (high - low);
  for (double x : wanted) {
    x = round_strain(x);
    const auto near = [&](double y) { return std::abs(x - y) < apart; };
    if (std::none_of(a.at.begin(), a.at.end(), near) && std::none_of(out.begin(), out.end(), near))
      out.push_back(x);
  }
  return out;
}

Refinement new_point(const AdditiveModel& model, int addend, double x, double typical) {
  Refinement out;
  out.add = [name = model.addends[addend].name, x](AdditiveModel& to) {
    for (size_t i = 0; i < to.addends.size(); ++i)
      if (to.addends[i].name == name) to = refined(to, static_cast<int>(i), x);
  };
  AdditiveModel larger = model;
  out.add(larger);
  const Addend& a = larger.addends[addend];
  const auto i = static_cast<size_t>(std::lower_bound(a.at.begin(), a.at.end(), x) - a.at.begin());
  std::vector<double> at;
  for (size_t k = i == 0 ? 0 : i - 1; k < std::min(i + 2, a.at.size()); ++k) at.push_back(a.at[k]);
  VectorXd hat = VectorXd::Zero(static_cast<Eigen::Index>(at.size()));
  hat[i == 0 ? 0 : 1] = 1.0;
  out.what = fmt::format("control point {} = {:g}", a.name, x);
  AdditiveModel function = alone(model, a.name, at, hat);
  function.addends[0].even = a.even;
  out.candidate = candidate_of(function, false, typical, out.what);
  return out;
}

Refinement new_addend(const AdditiveModel& model, const std::string& name, bool one_sided,
                      double typical) {
  Refinement out;
  out.add = [name](AdditiveModel& to) {
    std::vector<double> at_second;
    if (name.find('_') != std::string::npos) at_second = {0.0};
    add_addend(to, name, {0.0}, at_second, VectorXd::Zero(1));
  };
  out.what = "addend " + name;
  out.candidate =
      candidate_of(alone(model, name, {0.0}, VectorXd::Ones(1)), one_sided, typical, out.what);
  return out;
}

}  // namespace

std::vector<Refinement> refinements(const ModelForm& form, const Fitted& fitted) {
  const AdditivePart part = find_additive(form, fitted.p);
  const AdditiveModel& model = part.model;
  const double typical = model.values().cwiseAbs().maxCoeff();
  std::vector<Refinement> out;
  const VisitedStrains visited = visited_strains(form, fitted, model);
  for (size_t a = 0; a < model.addends.size(); ++a) {
    const Addend& addend = model.addends[a];
    if (addend.fixed || addend.second >= 0 || addend.at.size() >= kMostControlPoints) continue;
    const double low = visited.low[addend.first], high = visited.high[addend.first];
    if (!(high - low > 1e-6)) continue;
    for (double x : new_points(addend, low, high))
      out.push_back(new_point(model, static_cast<int>(a), x, typical));
  }
  const std::vector<std::string> normal = {"E11", "E22", "E33"};
  for (const char* name : {"E11", "E22", "E33", "E12", "E13", "E23", "I1bar", "J"})
    if (!model.find(name)) out.push_back(new_addend(model, name, true, typical));
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = i + 1; j < 3; ++j) {
      const std::string name = normal[i] + "_" + normal[j];
      // A coupling without a modulus on both axes is not convex.
      if (model.find(normal[i]) && model.find(normal[j]) && !model.find(name))
        out.push_back(new_addend(model, name, false, typical));
    }
  return out;
}

}  // namespace hookeye
