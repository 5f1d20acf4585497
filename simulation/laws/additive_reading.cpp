// `material: {law: additive, ...}`: reading, and what can be wrong with a model.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>
#include <set>

#include "simulation/additive.h"
#include "simulation/laws/additive_addends.h"
#include "simulation/laws/material_frame.h"

namespace hookeye {
namespace {

using Kind = StrainComponent::Kind;

/// Smallest strain that a component can have.
double lowest(Kind kind) {
  switch (kind) {
    case Kind::e11:
    case Kind::e22:
    case Kind::e33:
      return -0.5;
    case Kind::trace:
      return -1.5;
    case Kind::i1bar:
      return 0.0;
    case Kind::volume:
    case Kind::fibre:
      return -1.0;
    default:
      return -std::numeric_limits<double>::infinity();
  }
}

std::optional<AdditiveFault> points_fault(const std::string& key, const std::vector<double>& at,
                                          const StrainComponent& component) {
  if (at.size() > kMostControlPoints)
    return AdditiveFault{key, fmt::format("`{}` has {} control points", key, at.size()),
                         fmt::format("at most {}", kMostControlPoints)};
  const double low = lowest(component.kind);
  for (size_t i = 0; i < at.size(); ++i) {
    if (!std::isfinite(at[i]))
      return AdditiveFault{key, fmt::format("control point {} of `{}` is {}", i + 1, key, at[i]),
                           "a finite number"};
    if (at[i] < low || (at[i] == low && low < 0))
      return AdditiveFault{key, fmt::format("control point {} of `{}` is {}", i + 1, key, at[i]),
                           fmt::format("{} cannot be {} {}", component.name,
                                       low < 0 ? "at or below" : "below", low)};
    if (i > 0 && at[i] == at[i - 1])
      return AdditiveFault{key, fmt::format("control point {} of `{}` stands twice", at[i], key),
                           "give every control point once"};
    if (i > 0 && at[i] < at[i - 1])
      return AdditiveFault{key,
                           fmt::format("the control points of `{}` are out of order: {} after {}",
                                       key, at[i], at[i - 1]),
                           "write them from the smallest to the largest, with their values"};
  }
  return {};
}

std::optional<AdditiveFault> addend_fault(const AdditiveModel& model, const Addend& a) {
  const StrainComponent& first = model.components[a.first];
  if (auto wrong = points_fault(a.name + ".at", a.at, first)) return wrong;
  size_t count = a.at.size();
  if (a.second >= 0) {
    const StrainComponent& second = model.components[a.second];
    if (a.first == a.second)
      return AdditiveFault{a.name, fmt::format("`{}` ties a component to itself", a.name),
                           "two different components"};
    if (first.kind == Kind::i1bar || second.kind == Kind::i1bar)
      return AdditiveFault{a.name, fmt::format("`{}`: I1bar stands alone", a.name),
                           "its stress would jump at rest; tie other components"};
    if (auto wrong = points_fault(a.name + ".at_2", a.at_second, second)) return wrong;
    // d2W/db2 would grow with a, and no control point along a says how far.
    if ((a.at.size() == 1) != (a.at_second.size() == 1))
      return AdditiveFault{
          a.name + ".at",
          fmt::format("`{}` has {} control points along {} and {} along {}", a.name, a.at.size(),
                      first.name, a.at_second.size(), second.name),
          "one along both (a constant coupling), or two and more along both"};
    count *= a.at_second.size();
  }
  const std::string key = a.name + ".stiffness";
  if (static_cast<size_t>(a.stiffness.size()) != count || count == 0)
    return AdditiveFault{key, fmt::format("`{}` has {} values", key, a.stiffness.size()),
                         fmt::format("{} values, one for every control point", count)};
  if (!a.stiffness.allFinite())
    return AdditiveFault{key, fmt::format("a value of `{}` is not finite", key), "finite numbers"};
  return {};
}

/// The values that lower the eigenvalue most: v^T H v is the sum of what the addends bring.
std::string least_convex(const AdditiveModel& model, const ConvexityTest& test) {
  std::string key;
  double lowest = 0.0;
  Eigen::Index offset = 0;
  for (const Addend& a : model.addends) {
    if (a.fixed) continue;
    const double brings = test.gradient.segment(offset, a.stiffness.size()).dot(a.stiffness);
    offset += a.stiffness.size();
    if (brings < lowest) lowest = brings, key = a.name + ".stiffness";
  }
  return key;
}

/// The small-strain stiffness must resist every strain.
std::optional<AdditiveFault> rest_fault(const AdditiveModel& model) {
  const Matrix9d D = additive(model)->dP_dF(Matrix3d::Identity());
  Eigen::Matrix<double, 9, 6> strain = Eigen::Matrix<double, 9, 6>::Zero();
  const int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (int i = 0; i < 3; ++i) {
    strain(4 * i, i) = 1.0;
    strain(pairs[i][0] + 3 * pairs[i][1], 3 + i) = std::sqrt(0.5);
    strain(pairs[i][1] + 3 * pairs[i][0], 3 + i) = std::sqrt(0.5);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(strain.transpose() * D *
                                                                         strain);
  if (eigen.eigenvalues()[0] > 1e-9 * eigen.eigenvalues()[5]) return {};
  const Eigen::Matrix<double, 6, 1> v = eigen.eigenvectors().col(0);
  return AdditiveFault{
      "",
      fmt::format("at rest nothing resists the strain (E11 {:.2g}, E22 {:.2g}, E33 {:.2g}, "
                  "E12 {:.2g}, E13 {:.2g}, E23 {:.2g}, rest axes)",
                  v[0], v[1], v[2], v[3] * std::sqrt(0.5), v[4] * std::sqrt(0.5),
                  v[5] * std::sqrt(0.5)),
      "add an addend for it, or I1bar and J as in {I1bar: {at: [0], stiffness: [MU]}, "
      "J: {at: [0], stiffness: [KAPPA]}}"};
}

/// One addend's keys as the capture's map holds them.
class Reader {
 public:
  explicit Reader(const MaterialSpec& spec) : spec_(spec) {}

  AdditiveModel read() {
    AdditiveModel model;
    read_frame(model);
    read_barrier(model);
    for (const std::string& name : names()) read_addend(name, model);
    if (model.addends.empty())
      throw InputError(spec_.place, "the law additive has no addends",
                       "for example {I1bar: {at: [0], stiffness: [MU]}, J: {at: [0], stiffness: "
                       "[KAPPA]}}");
    for (const auto& [key, value] : spec_.parameters)
      if (!used_.count(key)) {
        const std::string part =
            key.find('.') == std::string::npos ? key : key.substr(0, key.find('.'));
        throw InputError(value.place, fmt::format("the law additive has no `{}`", key),
                         fmt::format("`{}` takes at, at_2, stiffness, direction, wall", part));
      }
    return model;
  }

 private:
  const MaterialSpec::Value* find(const std::string& key) {
    const auto found = spec_.parameters.find(key);
    if (found == spec_.parameters.end()) return nullptr;
    used_.insert(key);
    return &found->second;
  }
  const MaterialSpec::Value& need(const std::string& key, size_t count, const std::string& right) {
    const MaterialSpec::Value* value = find(key);
    if (!value) throw InputError(spec_.place, fmt::format("additive lacks `{}`", key), right);
    if (count && value->numbers.size() != count)
      throw InputError(value->place, fmt::format("`{}` has {} numbers", key, value->numbers.size()),
                       right);
    return *value;
  }
  /// The addends' names, in the order of the alphabet.
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& [key, value] : spec_.parameters) {
      const std::string name = key.substr(0, key.find('.'));
      if (name != "frame" && name != "barrier") all.insert(name);
    }
    return all;
  }

  void read_frame(AdditiveModel& model) {
    if (const auto* rows = find("frame")) model.frame = laws::read_frame(*rows);
    if (spec_.parameters.count("frame.axis") || spec_.parameters.count("frame.center"))
      model.cylinder = laws::read_cylinder(need("frame.axis", 0, "a direction: [0, 0, 1]"),
                                           need("frame.center", 0, "a point on it: [0, 0, 0]"));
  }
  void read_barrier(AdditiveModel& model) {
    if (!spec_.parameters.count("barrier.modulus") && !spec_.parameters.count("barrier.below"))
      return;
    const auto& modulus = need("barrier.modulus", 1, "a number from 0 [stress]");
    const auto& below = need("barrier.below", 1, "a volume ratio J between 0 and 1");
    model.barrier_modulus = modulus.numbers[0];
    model.barrier_below = below.numbers[0];
    if (!(model.barrier_below > 0 && model.barrier_below < 1))
      throw InputError(below.place, fmt::format("the barrier begins at J = {}", below.numbers[0]),
                       "a volume ratio between 0 and 1");
  }
  void read_addend(const std::string& name, AdditiveModel& model) {
    const Place place = first_place(name);
    try {
      const size_t split = name.find('_');
      component_index(model, name.substr(0, split));
      if (split != std::string::npos) component_index(model, name.substr(split + 1));
    } catch (const std::invalid_argument&) {
      throw InputError(
          place, fmt::format("the law additive has no addend `{}`", name),
          "E11 E22 E33 E12 E13 E23 trE I1bar J fibre1 ... fibre9, or two of them as in "
          "E11_E22");
    }
    read_directions(name, model);
    const bool wall_only =
        spec_.parameters.count(name + ".wall") && !spec_.parameters.count(name + ".at");
    if (!wall_only) {
      const auto at = need(name + ".at", 0, "control points: [-0.2, 0, 0.4]").numbers;
      const auto& values = need(name + ".stiffness", 0, "one value for every control point");
      std::vector<double> at_2;
      if (name.find('_') != std::string::npos)
        at_2 = need(name + ".at_2", 0, "control points of the second component").numbers;
      add_addend(model, name, at, at_2,
                 Eigen::Map<const Eigen::VectorXd>(
                     values.numbers.data(), static_cast<Eigen::Index>(values.numbers.size())));
    }
    read_wall(name, model);
  }
  void read_directions(const std::string& name, AdditiveModel& model) {
    const size_t split = name.find('_');
    if (split != std::string::npos) {
      for (const std::string& part : {name.substr(0, split), name.substr(split + 1)})
        if (part.rfind("fibre", 0) == 0 && !spec_.parameters.count(part + ".direction"))
          throw InputError(
              first_place(name), fmt::format("`{}` needs the direction of {}", name, part),
              fmt::format("{}: {{direction: [1, 0, 0], at: [0], stiffness: [0]}}", part));
      return;
    }
    if (name.rfind("fibre", 0) != 0) return;
    const auto& value = need(name + ".direction", 3, "a direction in rest axes: [1, 0, 0]");
    const Eigen::Vector3d d = Eigen::Map<const Eigen::Vector3d>(value.numbers.data());
    if (!(d.norm() > 0))
      throw InputError(value.place, "the fibre's direction has no length", "a direction");
    model.components[component_index(model, name)].direction = d.normalized();
  }
  void read_wall(const std::string& name, AdditiveModel& model) {
    const MaterialSpec::Value* wall = find(name + ".wall");
    if (!wall) return;
    const char* right =
        "three numbers: the strain where it begins, the width over which it rises, "
        "its modulus; only for one component";
    if (wall->numbers.size() != 3 || name.find('_') != std::string::npos ||
        !(wall->numbers[1] > 0) || !(wall->numbers[2] >= 0) || wall->numbers[0] == 0)
      throw InputError(wall->place, fmt::format("`{}.wall` is not a wall", name), right);
    const double begin = wall->numbers[0], width = wall->numbers[1], modulus = wall->numbers[2];
    const bool up = begin > 0;
    const std::vector<double> at = {up ? begin : begin - width, up ? begin + width : begin};
    if (auto wrong =
            points_fault(name + ".wall", at, model.components[component_index(model, name)]))
      throw InputError(wall->place, wrong->wrong, wrong->right);
    add_addend(model, name, at, {}, Eigen::Vector2d(up ? 0 : modulus, up ? modulus : 0));
    model.addends.back().name += ".wall";
    model.addends.back().fixed = true;
  }
  Place first_place(const std::string& name) const {
    for (const auto& [key, value] : spec_.parameters)
      if (key.substr(0, key.find('.')) == name) return value.place;
    return spec_.place;
  }

  const MaterialSpec& spec_;
  std::set<std::string> used_;
};

}  // namespace

std::optional<AdditiveFault> structure_fault(const AdditiveModel& model) {
  if (!((model.frame.transpose() * model.frame - Matrix3d::Identity()).norm() < 1e-9))
    return AdditiveFault{"frame", "the material frame is not orthonormal",
                         "three unit vectors at right angles"};
  if (!(model.frame.determinant() > 0))
    return AdditiveFault{"frame", "the material frame is left-handed",
                         "axis 3 is the cross product of axes 1 and 2: turn one of the axes round"};
  for (const StrainComponent& c : model.components)
    if (c.kind == StrainComponent::Kind::fibre && !(std::abs(c.direction.norm() - 1.0) < 1e-9))
      return AdditiveFault{c.name + ".direction",
                           fmt::format("the direction of {} is no unit vector", c.name),
                           "three numbers whose squares add up to 1"};
  if (!(model.barrier_modulus >= 0) || !std::isfinite(model.barrier_modulus))
    return AdditiveFault{"barrier.modulus",
                         fmt::format("the barrier's modulus is {}", model.barrier_modulus),
                         "a number from 0"};
  if (model.barrier_modulus > 0 && !(model.barrier_below > 0 && model.barrier_below < 1))
    return AdditiveFault{"barrier.below",
                         fmt::format("the barrier begins at J = {}", model.barrier_below),
                         "a volume ratio between 0 and 1"};
  std::set<std::set<int>> seen;
  for (const Addend& a : model.addends) {
    if (auto wrong = addend_fault(model, a)) return wrong;
    if (a.second >= 0 && !seen.insert({a.first, a.second}).second)
      return AdditiveFault{a.name, fmt::format("`{}` stands twice, in either order", a.name),
                           "one addend for every pair"};
  }
  return {};
}

std::optional<AdditiveFault> convexity_fault(const AdditiveModel& model) {
  double scale = 0.0;
  for (const Addend& a : model.addends) scale = std::max(scale, a.stiffness.cwiseAbs().maxCoeff());
  const ConvexityTest convex = smallest_eigenvalue(model);
  if (convex.smallest >= -1e-12 * scale) return {};
  return AdditiveFault{least_convex(model, convex),
                       fmt::format("the energy is not convex at {}: smallest eigenvalue {:.3g}",
                                   convex.where, convex.smallest),
                       "raise the tangent moduli there, or lower the coupling moduli"};
}

std::optional<AdditiveFault> fault(const AdditiveModel& model) {
  if (auto wrong = structure_fault(model)) return wrong;
  if (auto wrong = convexity_fault(model)) return wrong;
  return rest_fault(model);
}

AdditiveModel read_additive(const MaterialSpec& spec) {
  const AdditiveModel model = Reader(spec).read();
  if (const auto wrong = fault(model)) {
    const auto value = spec.parameters.find(wrong->key);
    throw InputError(value == spec.parameters.end() ? spec.place : value->second.place,
                     wrong->wrong, wrong->right);
  }
  return model;
}

}  // namespace hookeye
