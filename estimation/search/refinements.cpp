// Where an additive material may need one function more.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimation/fit/energy_curves.h"
#include "estimation/model/additive_function.h"
#include "estimation/model/additive_material.h"
#include "estimation/search/progressive.h"

namespace hookeye {
namespace {

/// Term with one addend alone: at its null 0.
AdditiveModel alone(const AdditiveModel& like, const std::string& name, std::vector<double> at,
                    std::vector<double> at_second, const VectorXd& values) {
  AdditiveModel one;
  one.frame = like.frame;
  one.cylinder = like.cylinder;
  add_addend(one, name, std::move(at), std::move(at_second), values);
  for (StrainComponent& c : one.components)
    for (const StrainComponent& known : like.components)
      if (known.name == c.name) c.direction = known.direction;
  return one;
}

/// The material that is refined: its structure, where it acts, and the size of its moduli.
struct Material {
  const AdditivePart& part;
  size_t index;
  double typical;
  std::string named(const std::string& addend) const {
    return part.place.label.empty() ? addend : part.place.label + "." + addend;
  }
};

std::shared_ptr<const Ingredient> candidate_of(const AdditiveModel& function, bool one_sided,
                                               const Material& material, const std::string& what) {
  FunctionSpec spec;
  spec.name = what;
  Parameter t;
  t.name = "t";
  t.typical = material.typical;
  if (one_sided) t.low = 0.0;
  spec.parameters = {t};
  spec.like_part = material.part.place.part;
  spec.functions = [function](const VectorXd& values) {
    AdditiveModel scaled = function;
    scaled.set_values(values[0] * function.values());
    return scaled;
  };
  return additive_function(std::move(spec));
}

/// Rounded so that files and sentences show the very control point.
double round_strain(double e) { return std::stod(fmt::format("{:.3g}", e)) + 0.0; }

/// Ends of the visited range and middles of the intervals in it, where there is no point yet.
std::vector<double> new_points(const std::vector<double>& at, bool even, double low, double high) {
  if (even) high = std::max(high, -low), low = 0.0;
  std::vector<double> marks = {low, high};
  for (double x : at)
    if (x > low && x < high) marks.push_back(x);
  std::sort(marks.begin(), marks.end());
  std::vector<double> wanted = {low, high};
  for (size_t i = 0; i + 1 < marks.size(); ++i) wanted.push_back(0.5 * (marks[i] + marks[i + 1]));
  std::vector<double> out;
  const double apart = 0.05 * (high - low);
  for (double x : wanted) {
    x = round_strain(x);
    const auto near = [&](double y) { return std::abs(x - y) < apart; };
    if (std::none_of(at.begin(), at.end(), near) && std::none_of(out.begin(), out.end(), near))
      out.push_back(x);
  }
  return out;
}

/// The hat of control point x among `at`: its neighbours and itself.
std::pair<std::vector<double>, VectorXd> hat_at(const std::vector<double>& at, double x) {
  const auto i = static_cast<size_t>(std::lower_bound(at.begin(), at.end(), x) - at.begin());
  std::vector<double> around;
  for (size_t k = i == 0 ? 0 : i - 1; k < std::min(i + 2, at.size()); ++k) around.push_back(at[k]);
  VectorXd hat = VectorXd::Zero(static_cast<Eigen::Index>(around.size()));
  hat[i == 0 ? 0 : 1] = 1.0;
  return {around, hat};
}

/// Where a control point is to come: along which component of an addend. A coupling has one point
/// on either side or more on both: `other_end` is where the other side gets its second.
struct NewPoint {
  std::string addend;
  double x;
  bool second = false;
  double other_end = 0.0;
  void add_to(AdditiveModel& to) const {
    for (int i = 0; i < static_cast<int>(to.addends.size()); ++i) {
      if (to.addends[i].name != addend) continue;
      to = refined(to, i, x, second);
      const Addend& now = to.addends[i];
      if (now.second >= 0 && (second ? now.at : now.at_second).size() == 1)
        to = refined(to, i, other_end, !second);
    }
  }
};

/// For a coupling the score is that of a ridge, the same hat all along the other component; the fit
/// then moves the points one by one.
Refinement with_point(const Material& material, const Addend& addend, const NewPoint& point) {
  const AdditiveModel& model = material.part.model;
  Refinement out;
  out.material = material.index;
  out.grid = addend.second >= 0;
  out.add = [point](AdditiveModel& to) { point.add_to(to); };
  const int component = point.second ? addend.second : addend.first;
  out.what = fmt::format(
      "control point {} = {:g}",
      addend.second < 0 ? material.named(addend.name)
                        : material.named(addend.name) + ": " + model.components[component].name,
      point.x);
  std::vector<double> at = point.second ? addend.at_second : addend.at;
  at.insert(std::lower_bound(at.begin(), at.end(), point.x), point.x);
  const auto [around, hat] = hat_at(at, point.x);
  AdditiveModel function;
  if (addend.second < 0)
    function = alone(model, addend.name, around, {}, hat);
  else if (point.second)
    function = alone(model, addend.name, {0.0}, around, hat);
  else
    function = alone(model, addend.name, around, {0.0}, hat);
  function.addends[0].even = addend.even;
  out.candidate = candidate_of(function, false, material, out.what);
  return out;
}

Refinement new_addend(const Material& material, const std::string& name, bool one_sided) {
  std::vector<double> at_second;
  if (name.find('_') != std::string::npos) at_second = {0.0};
  Refinement out;
  out.material = material.index;
  out.add = [name, at_second](AdditiveModel& to) {
    add_addend(to, name, {0.0}, at_second, VectorXd::Zero(1));
  };
  out.what = "addend " + material.named(name);
  out.candidate =
      candidate_of(alone(material.part.model, name, {0.0}, at_second, VectorXd::Ones(1)), one_sided,
                   material, out.what);
  return out;
}

/// Control points for every addend where the examples visit its components.
void points_of(const Material& material, const VisitedStrains& visited,
               std::vector<Refinement>& out) {
  for (const Addend& addend : material.part.model.addends) {
    if (addend.fixed) continue;
    const auto end_of = [&](int component) {
      const double low = visited.low[component], high = visited.high[component];
      return round_strain(high > -low ? high : low);
    };
    for (bool second : {false, true}) {
      const int component = second ? addend.second : addend.first;
      if (component < 0) continue;
      const auto& at = second ? addend.at_second : addend.at;
      const double low = visited.low[component], high = visited.high[component];
      const double other_end =
          addend.second < 0 ? 0.0 : end_of(second ? addend.first : addend.second);
      if (at.size() >= kMostControlPoints || !(high - low > 1e-6)) continue;
      if (addend.second >= 0 && other_end == 0.0) continue;  // it is visited along one axis only
      for (double x : new_points(at, addend.even, low, high))
        out.push_back(with_point(material, addend, {addend.name, x, second, other_end}));
    }
  }
}

/// Addends for components that have none, and couplings of two that have one.
void addends_of(const Material& material, std::vector<Refinement>& out) {
  const AdditiveModel& model = material.part.model;
  const std::vector<std::string> normal = {"E11", "E22", "E33"};
  for (const char* name : {"E11", "E22", "E33", "E12", "E13", "E23", "I1bar", "J"})
    if (!model.find(name)) out.push_back(new_addend(material, name, true));
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = i + 1; j < 3; ++j) {
      const std::string name = normal[i] + "_" + normal[j];
      // A coupling without a modulus on both axes is not convex.
      if (model.find(normal[i]) && model.find(normal[j]) && !model.find(name))
        out.push_back(new_addend(material, name, false));
    }
}

}  // namespace

std::vector<Refinement> refinements(const ModelForm& form, const Fitted& fitted) {
  const std::vector<AdditivePart> parts = additive_parts(form, fitted.p);
  std::vector<Refinement> out;
  for (size_t i = 0; i < parts.size(); ++i) {
    const AdditiveModel& model = parts[i].model;
    const Material material{parts[i], i, model.values().cwiseAbs().maxCoeff()};
    points_of(material, visited_strains(form, fitted, model, parts[i].place.part), out);
    addends_of(material, out);
  }
  return out;
}

}  // namespace hookeye
