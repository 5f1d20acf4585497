#include "estimation/effects/stiffness_forms.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

namespace hookeye {

namespace {

const char* const kTransverse = "free stiffnesses around";
const char* const kOrthotropic = "free orthotropic around";
const char* const kLinear = "free orthotropic, linear in the Green strain, around";
const char* const kAll = "free stiffnesses of all strains";
const char* const kStiffness[] = {"c11", "c22", "c33", "c12", "c13", "c23", "g12", "g13"};
const int kConstants = 20;  ///< of all stiffnesses

/// Columns: `a` and two axes across.
Matrix3d frame_along(const Vector3d& a) {
  const auto [b, c] = normal_axes(a);
  Matrix3d frame;
  frame << a.normalized(), b, c;
  return frame;
}

/// The two axes across follow when `a` turns.
Matrix3d turned_frame(const Vector3d& a, double t1, double t2, double about) {
  const Matrix3d frame = frame_along(a);
  return rotation_of(t1 * frame.col(1) + t2 * frame.col(2)) * rotation_of(about * frame.col(0)) *
         frame;
}

/// Of energies without stress at rest.
Stiffness6 at_rest(const EnergyTerm& term) {
  const Matrix9d D = term.dP_dF(Matrix3d::Identity());
  constexpr int kAt[] = {0, 4, 8, 7, 6, 3};  // dF11, dF22, dF33, dF23, dF13, dF12
  Stiffness6 C;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) C(i, j) = D(kAt[i], kAt[j]);
  return C;
}

/// Stiffnesses of the base law.
Stiffness6 at_rest(const EnergyModel& energy) {
  Stiffness6 C = Stiffness6::Zero();
  for (const auto& part : energy.parts)
    if (part.weight.size() == 0 || &part == &energy.parts.front()) C += at_rest(*part.term);
  return C;
}

Stiffness6 isotropic(double lambda, double mu) {
  Stiffness6 C = Stiffness6::Zero();
  C.topLeftCorner<3, 3>().setConstant(lambda);
  C.diagonal().array() += mu;
  C.diagonal().head<3>().array() += mu;
  return C;
}

/// One law for the whole body, the same in all directions at rest: what could be stvk's.
bool is_isotropic_at_rest(const EnergyModel& energy) {
  if (energy.parts.empty() || energy.parts[0].weight.size() || energy.parts[0].frames.size())
    return false;
  const Stiffness6 C = at_rest(*energy.parts[0].term);
  return C.isApprox(isotropic(C(0, 1), C(5, 5)), 1e-6);
}

Parameter share_of_stvk() {
  return {"anisotropy.linear",
          "",
          "share of the base law that is linear in E",
          0.0,
          0.0,
          1.5,
          1.0,
          false};
}

/// (1 - share) of the base law, share of stvk with the same stiffnesses at rest.
void go_over_to_stvk(double share, EnergyModel& energy) {
  const auto base = energy.parts[0].term;
  const Stiffness6 C = at_rest(*base);
  add_part(energy, combination({{share, stvk(C(0, 1), C(5, 5))}, {-share, base}}));
}

VectorXd transverse_stiffnesses(const VectorXd& v) {
  VectorXd x = VectorXd::Zero(9);
  x[0] = v[0], x[3] = x[4] = v[2], x[6] = x[7] = v[1];
  return x;
}

VectorXd orthotropic_stiffnesses(const VectorXd& v) {
  VectorXd x = VectorXd::Zero(9);
  x.head(8) = v.head(8);
  return x;
}

std::vector<Parameter> orthotropic_parameters(const Model& model) {
  std::vector<Parameter> all;
  for (int k = 0; k < 8; ++k)
    all.push_back(modulus_of(model, kStiffness[k], fmt::format("stiffness {} added", kStiffness[k]),
                             k < 3   ? -2.0
                             : k < 6 ? -1e3
                                     : -0.95));
  for (const Parameter& angle : fibre_angles()) all.push_back(angle);
  all.push_back(
      {"anisotropy.angle3", "rad", "angle about the first axis", 0.0, -3.2, 3.2, 0.2, false});
  return all;
}

std::shared_ptr<const EnergyTerm> orthotropic_term(const VectorXd& v, const Vector3d& a) {
  return orthotropic(
      orthotropic_values(orthotropic_stiffnesses(v), turned_frame(a, v[8], v[9], v[10])));
}

/// C11 .. C66 row by row without C44.
Stiffness6 constants_of(const VectorXd& v) {
  Stiffness6 C = Stiffness6::Zero();
  int k = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j)
      if (i != 3 || j != 3) C(i, j) = C(j, i) = v[k++];
  return C;
}

/// The values of all_stiffnesses() with this C, but for C44, and share.
VectorXd values_of(const Stiffness6& C, double share) {
  VectorXd v(kConstants + 1);
  int k = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j)
      if (i != 3 || j != 3) v[k++] = C(i, j);
  v[kConstants] = share;
  return v;
}

/// Axes of symmetry where there are such: those of C_ikjk (Cowin and Mehrabadi 1987).
Matrix3d symmetry_frame(const Stiffness6& C) {
  Matrix3d V;
  V << C(0, 0) + C(5, 5) + C(4, 4), C(0, 5) + C(1, 5) + C(3, 4), C(0, 4) + C(2, 4) + C(3, 5),
      C(0, 5) + C(1, 5) + C(3, 4), C(5, 5) + C(1, 1) + C(3, 3), C(1, 3) + C(2, 3) + C(4, 5),
      C(0, 4) + C(2, 4) + C(3, 5), C(1, 3) + C(2, 3) + C(4, 5), C(4, 4) + C(3, 3) + C(2, 2);
  Matrix3d frame = Eigen::SelfAdjointEigenSolver<Matrix3d>(V).eigenvectors().rowwise().reverse();
  if (frame.determinant() < 0.0) frame.col(2) *= -1.0;
  return frame;
}

/// An axis has no sign: the largest component is told as positive.
std::string axis_text(const Vector3d& axis) {
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return vector_text(axis[largest] < 0.0 ? Vector3d(-axis) : axis);
}

/// Young's moduli along the axes and shear moduli, of base and effect together. A stiffness by
/// which some strain would set energy free has none: NaN.
std::string constants_text(const Model& model, const Stiffness6& added, const Matrix3d& frame) {
  const Stiffness6 C = stiffness_in_frame(at_rest(model.energy) + added, frame);
  const bool stable = Eigen::LLT<Stiffness6>(C).info() == Eigen::Success;
  const Stiffness6 compliance =
      stable ? Stiffness6(C.inverse()) : Stiffness6::Constant(std::nan(""));
  const std::string stress = model.scene->capture.units.stress();
  std::string text;
  for (int i = 0; i < 3; ++i)
    text += fmt::format("{}{} {} along {}", i == 0 ? "Young's modulus " : ", ",
                        figure(1.0 / compliance(i, i)), stress, axis_text(frame.col(i)));
  return fmt::format("{}; shear moduli with the first axis {} and {} {}, across it {}", text,
                     figure(1.0 / compliance(5, 5)), figure(1.0 / compliance(4, 4)), stress,
                     figure(1.0 / compliance(3, 3)));
}

std::string linear_text(double share) {
  return fmt::format("; {} % of the law linear between stress and Green strain",
                     figure(100.0 * share));
}

using MakeTerm = std::function<std::shared_ptr<const EnergyTerm>(const VectorXd&)>;

/// The values before the angles are moduli, all null: nothing is added.
std::shared_ptr<const Ingredient> of_term(const std::string& start, const Vector3d& a,
                                          std::vector<Parameter> parameters, int moduli,
                                          MakeTerm term) {
  IngredientSpec spec;
  spec.name = "anisotropy";
  spec.variant = start + " " + vector_text(a, 3);
  spec.parameters = std::move(parameters);
  spec.touches = {.energy = true};
  spec.apply = [moduli, term = std::move(term)](const VectorXd& v, Model& m) {
    if (!v.head(moduli).isZero(0.0)) add_part(m.energy, term(v));
  };
  return make_ingredient(std::move(spec));
}

std::shared_ptr<const Ingredient> transverse_around(const Model& model, const Vector3d& a) {
  std::vector<Parameter> parameters = {
      modulus_of(model, "k", "modulus added along the fibre", -2.0),
      modulus_of(model, "shear", "shear modulus added along the fibre", -0.95),
      modulus_of(model, "coupling", "modulus that couples strains along and across", -1e3)};
  for (const Parameter& angle : fibre_angles()) parameters.push_back(angle);
  return of_term(kTransverse, a, std::move(parameters), 3, [a](const VectorXd& v) {
    return orthotropic(
        orthotropic_values(transverse_stiffnesses(v), turned_frame(a, v[3], v[4], 0.0)));
  });
}

/// Around the frame whose first axis is `a`.
std::shared_ptr<const Ingredient> orthotropic_around(const Model& model, const Vector3d& a) {
  return of_term(kOrthotropic, a, orthotropic_parameters(model), 8,
                 [a](const VectorXd& v) { return orthotropic_term(v, a); });
}

std::shared_ptr<const Ingredient> linear_orthotropic_around(const Model& model, const Vector3d& a) {
  IngredientSpec spec;
  spec.name = "anisotropy";
  spec.variant = fmt::format("{} {}", kLinear, vector_text(a, 3));
  spec.parameters = orthotropic_parameters(model);
  spec.parameters.push_back(share_of_stvk());
  spec.touches = {.energy = true};
  spec.apply = [a](const VectorXd& v, Model& m) {
    if (v[11] != 0.0) go_over_to_stvk(v[11], m.energy);
    if (!v.head(8).isZero(0.0)) add_part(m.energy, orthotropic_term(v, a));
  };
  return make_ingredient(std::move(spec));
}

std::shared_ptr<const Ingredient> all_stiffnesses(const Model& model) {
  const Stiffness6 base = at_rest(model.energy);
  const double mu = initial_shear_modulus(model.energy);
  IngredientSpec spec;
  spec.name = "anisotropy";
  spec.variant = kAll;
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j)
      if (i != 3 || j != 3)
        spec.parameters.push_back(modulus_of(model, fmt::format("C{}{}", i + 1, j + 1),
                                             fmt::format("stiffness C{}{} added", i + 1, j + 1),
                                             i == j ? -0.95 * base(i, i) / mu : -1e3));
  spec.parameters.push_back(share_of_stvk());
  spec.touches = {.energy = true};
  spec.apply = [](const VectorXd& v, Model& m) {
    if (v[kConstants] != 0.0) go_over_to_stvk(v[kConstants], m.energy);
    if (!v.head(kConstants).isZero(0.0)) add_part(m.energy, anisotropic(constants_of(v)));
  };
  spec.derivative = [](const VectorXd&, const Model& m, int example, const Equilibrium& equilibrium,
                       int k, MechanicsDerivative& out) {
    if (k == kConstants) return false;
    out.dR_dt = part_force(m, example, equilibrium.q,
                           anisotropic(constants_of(VectorXd::Unit(kConstants, k))));
    return true;
  };
  return make_ingredient(std::move(spec));
}

/// A fibre's energy at rest in the Green strain, but for a part of the volume alone.
VectorXd fibre_at_rest(double k) {
  VectorXd constants(5);
  constants << 4.0 / 3.0 * k, 0.0, -4.0 / 3.0 * k, 0.0, 0.0;
  return constants;
}

/// The transverse form around each axis of an orthotropic one: the axis that the fibre stood for
/// may be another than that of the symmetry. Each starts near the base law, where it has an
/// equilibrium: what eleven values share between them may have none in five.
void add_transverse(const Model& model, const Matrix3d& frame, std::vector<NextForm>& all) {
  VectorXd start = VectorXd::Zero(5);
  start.head(2).setConstant(0.1 * initial_shear_modulus(model.energy));
  for (int i = 0; i < 3; ++i)
    all.push_back({transverse_around(model, rounded(frame.col(i), 1.0)), start});
}

/// From the same stiffnesses.
void add_all(const Model& model, const Stiffness6& C, std::vector<NextForm>& all) {
  if (is_isotropic_at_rest(model.energy))
    all.push_back({all_stiffnesses(model), values_of(C, 0.0)});
}

Stiffness6 in_rest_axes(const VectorXd& stiffnesses, const Matrix3d& frame) {
  return voigt_stiffness(orthotropic_values(stiffnesses, frame));
}

}  // namespace

Vector3d turned(const Vector3d& a, double t1, double t2) {
  const auto [first, second] = normal_axes(a);
  return rotation_of(t1 * first + t2 * second) * a.normalized();
}

Vector3d base_axis(const Ingredient& ingredient) {
  const auto n = numbers_in(ingredient.variant());
  return Vector3d(n.at(0), n.at(1), n.at(2)).normalized();
}

std::vector<Parameter> fibre_angles() {
  return {{"anisotropy.angle1", "rad", "first angle of the fibre", 0.0, -3.2, 3.2, 0.2, false},
          {"anisotropy.angle2", "rad", "second angle of the fibre", 0.0, -3.2, 3.2, 0.2, false}};
}

Parameter modulus_of(const Model& model, const std::string& name, const std::string& long_name,
                     double least) {
  const double mu = initial_shear_modulus(model.energy);
  return {"anisotropy." + name,
          model.scene->capture.units.stress(),
          long_name,
          0.0,
          least * mu,
          1e3 * mu,
          mu,
          false};
}

std::shared_ptr<const Ingredient> stiffness_form(const Model& model, const std::string& variant) {
  if (variant == kAll) return all_stiffnesses(model);
  const auto n = numbers_in(variant);
  if (n.size() != 3) return nullptr;
  const Vector3d a(n[0], n[1], n[2]);
  if (starts_with(variant, kTransverse)) return transverse_around(model, a);
  if (starts_with(variant, kLinear)) return linear_orthotropic_around(model, a);
  return starts_with(variant, kOrthotropic) ? orthotropic_around(model, a) : nullptr;
}

std::vector<NextForm> stiffnesses_after_fibre(const Model& model, const Vector3d& a, double k) {
  // A fibre that hardly stretches, or only pulls, is no guide: where both push as well, the body
  // may have no equilibrium.
  const VectorXd start = fibre_at_rest(std::min(k, initial_shear_modulus(model.energy)));
  std::vector<NextForm> all = {{transverse_around(model, a), start}};
  add_all(model, in_rest_axes(transverse_stiffnesses(start), frame_along(a)), all);
  return all;
}

std::vector<NextForm> further_stiffnesses(const Model& model, const Ingredient& refitted,
                                          const VectorXd& values) {
  std::vector<NextForm> all;
  if (starts_with(refitted.variant(), kTransverse)) {
    // In the plane across, the axes are anyone's: turned by 45 degrees they see another shear.
    const Vector3d a = rounded(base_axis(refitted), 1.0);
    const VectorXd x = transverse_stiffnesses(values);
    VectorXd start = VectorXd::Zero(11);
    start.head(8) = x.head(8);
    start.segment(8, 2) = values.tail(2);
    all.push_back({orthotropic_around(model, a), start});
    add_all(model, in_rest_axes(x, turned_frame(a, values[3], values[4], 0.0)), all);
  } else if (starts_with(refitted.variant(), kOrthotropic)) {
    const Matrix3d frame = turned_frame(base_axis(refitted), values[8], values[9], values[10]);
    add_all(model, in_rest_axes(orthotropic_stiffnesses(values), frame), all);
    add_transverse(model, frame, all);
  }
  return all;
}

std::vector<NextForm> plainer_stiffnesses(const Model& model, const Ingredient& refitted,
                                          const VectorXd& values) {
  if (refitted.variant() != kAll) return {};
  const Stiffness6 C = constants_of(values);
  const Matrix3d frame = symmetry_frame(C);
  const Vector3d a = rounded(frame.col(0), 1.0);
  const Matrix3d around = frame_along(a);
  const Stiffness6 own = stiffness_in_frame(C, frame);
  VectorXd plainer(12);
  plainer << own(0, 0), own(1, 1), own(2, 2), own(0, 1), own(0, 2), own(1, 2), own(5, 5), own(4, 4),
      0.0, 0.0, std::atan2(frame.col(1).dot(around.col(2)), frame.col(1).dot(around.col(1))),
      values[kConstants];
  return {{linear_orthotropic_around(model, a), std::move(plainer)}};
}

std::string stiffness_sentence(const Model& model, const Ingredient& ingredient,
                               const VectorXd& values) {
  const std::string variant = ingredient.variant();
  if (variant == kAll) {
    const Stiffness6 C = constants_of(values);
    return constants_text(model, C, symmetry_frame(C)) + linear_text(values[kConstants]);
  }
  const bool transverse = starts_with(variant, kTransverse);
  const bool linear = starts_with(variant, kLinear);
  if (!transverse && !linear && !starts_with(variant, kOrthotropic)) return {};
  const Vector3d a = base_axis(ingredient);
  const Matrix3d frame = transverse ? turned_frame(a, values[3], values[4], 0.0)
                                    : turned_frame(a, values[8], values[9], values[10]);
  const VectorXd x = transverse ? transverse_stiffnesses(values) : orthotropic_stiffnesses(values);
  return constants_text(model, in_rest_axes(x, frame), frame) +
         (linear ? linear_text(values[11]) : std::string());
}

}  // namespace hookeye
