#include "estimation/effects/fibre_forms.h"

#include <fmt/format.h>

#include <Eigen/LU>

namespace hookeye {

namespace {

const char* const kPullingAlong = "pulling along";
const char* const kPulling = "free pulling around";
const char* const kPullingVolume = "free pulling, volume counted, around";
const char* const kTransverse = "free stiffnesses around";
const char* const kOrthotropic = "free orthotropic around";
const char* const kStiffness[] = {"c11", "c22", "c33", "c12", "c13", "c23", "g12", "g13"};

std::vector<Parameter> angles() {
  return {{"anisotropy.angle1", "rad", "first angle of the fibre", 0.0, -3.2, 3.2, 0.2, false},
          {"anisotropy.angle2", "rad", "second angle of the fibre", 0.0, -3.2, 3.2, 0.2, false}};
}

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

using MakeTerm = std::function<std::shared_ptr<const EnergyTerm>(const VectorXd&)>;

/// The values before `angles` are moduli, all null: nothing is added.
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

/// Digits as they are written into variants, so that what is read back is the same.
Vector3d rounded(const Vector3d& a) {
  Vector3d out = a.normalized();
  for (double& x : out) x = std::round(1000.0 * x) / 1000.0;
  return out;
}

/// Stiffnesses of the base law at rest, 1/2 e:C:e with g of shear, in any frame.
OrthotropicValues at_rest(const EnergyModel& energy) {
  Matrix9d D = Matrix9d::Zero();
  for (const auto& part : energy.parts)
    if (part.weight.size() == 0 || &part == &energy.parts.front())
      D += part.term->dP_dF(Matrix3d::Identity());
  OrthotropicValues out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      out.c(i, j) = D(4 * i, 4 * j);
      if (i != j) out.g(i, j) = D(i + 3 * j, i + 3 * j);
    }
  return out;
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

/// Young's moduli along the axes and shear moduli, of base and effect together.
std::string constants_text(const Model& model, const VectorXd& stiffnesses, const Matrix3d& frame) {
  const OrthotropicValues base = at_rest(model.energy);
  const OrthotropicValues own = orthotropic_values(stiffnesses, frame);
  const Matrix3d compliance = (base.c + own.c).inverse(), g = base.g + own.g;
  const std::string stress = model.scene->capture.units.stress();
  std::string text;
  for (int i = 0; i < 3; ++i)
    text += fmt::format("{}{} {} along {}", i == 0 ? "Young's modulus " : ", ",
                        figure(1.0 / compliance(i, i)), stress, vector_text(frame.col(i)));
  return fmt::format("{}; shear moduli with the first axis {} and {} {}, across it {}", text,
                     figure(g(0, 1)), figure(g(0, 2)), stress, figure(g(1, 2)));
}

/// The direction in the variant's text.
Vector3d base_axis(const Ingredient& ingredient) {
  const auto n = numbers_in(ingredient.variant());
  return Vector3d(n.at(0), n.at(1), n.at(2)).normalized();
}

/// A fibre's energy at rest in the Green strain, but for a part of the volume alone.
VectorXd fibre_at_rest(double k) {
  VectorXd constants(5);
  constants << 4.0 / 3.0 * k, 0.0, -4.0 / 3.0 * k, 0.0, 0.0;
  return constants;
}

std::vector<Effect::Further> after_fibre(const Model& model, const VectorXd& values,
                                         const Vector3d& a) {
  const double k = values[0];
  std::vector<Effect::Further> all;
  if (k > 0.0) {
    const Eigen::Vector4d pulling(k, 0.0, 0.0, 0.0);
    all.push_back({pulling_around(model, a, false), pulling});
    all.push_back({pulling_around(model, a, true), pulling});
  }
  all.push_back({transverse_around(model, a), fibre_at_rest(k)});
  return all;
}

/// The transverse form around each axis of an orthotropic one: the axis that the fibre stood for
/// may be another than that of the symmetry. Each starts near the base law, where it has an
/// equilibrium: what eleven values share between them may have none in five.
std::vector<Effect::Further> after_orthotropic(const Model& model, const VectorXd& values,
                                               const Vector3d& a) {
  const Matrix3d frame = turned_frame(a, values[8], values[9], values[10]);
  const double little = 0.1 * initial_shear_modulus(model.energy);
  VectorXd start = VectorXd::Zero(5);
  start.head(2).setConstant(little);
  std::vector<Effect::Further> all;
  for (int i = 0; i < 3; ++i)
    all.push_back({transverse_around(model, rounded(frame.col(i))), start});
  return all;
}

}  // namespace

Vector3d turned(const Vector3d& a, double t1, double t2) {
  const auto [first, second] = normal_axes(a);
  return rotation_of(t1 * first + t2 * second) * a.normalized();
}

std::shared_ptr<const Ingredient> pulling_along(const Model& model, const Vector3d& a) {
  const auto term = [a](double k) {
    PullingFibreValues values;
    values.k1 = k, values.direction = a;
    return pulling_fibre(values);
  };
  IngredientSpec spec;
  spec.name = "anisotropy";
  spec.variant = fmt::format("{} {}", kPullingAlong, vector_text(a, 3));
  spec.parameters = {modulus_of(model, "k", "fibre modulus", 0.0)};
  spec.touches = {.energy = true};
  spec.apply = [term](const VectorXd& v, Model& m) {
    if (v[0] != 0.0) add_part(m.energy, term(v[0]));
  };
  spec.derivative = [term](const VectorXd& v, const Model& m, int example,
                           const Equilibrium& equilibrium, int, MechanicsDerivative& out) {
    if (v[0] != 0.0) return false;
    out.dR_dt = part_force(m, example, equilibrium.q, term(1.0));
    return true;
  };
  return make_ingredient(std::move(spec));
}

std::shared_ptr<const Ingredient> refit_of_pulling(const Model& model, const Ingredient& scored,
                                                   VectorXd& values) {
  if (!starts_with(scored.variant(), kPullingAlong)) return nullptr;
  values = Eigen::Vector4d(values[0], 0.0, 0.0, 0.0);
  return pulling_around(model, rounded(base_axis(scored)), false);
}

std::shared_ptr<const Ingredient> pulling_around(const Model& model, const Vector3d& a,
                                                 bool volume_counts) {
  std::vector<Parameter> parameters = {modulus_of(model, "k", "fibre modulus", 0.0)};
  // exp(k2 E^2) at a stretch of two, E = 3, is beyond any solver from 50 on
  parameters.push_back({"anisotropy.k2", "", "fibre exponent", 0.0, 0.0, 1e3, 1.0, false});
  for (const Parameter& angle : angles()) parameters.push_back(angle);
  return of_term(volume_counts ? kPullingVolume : kPulling, a, std::move(parameters), 1,
                 [a, volume_counts](const VectorXd& v) {
                   PullingFibreValues values;
                   values.k1 = v[0], values.k2 = v[1];
                   values.direction = turned(a, v[2], v[3]);
                   values.volume_counts = volume_counts;
                   return pulling_fibre(values);
                 });
}

std::shared_ptr<const Ingredient> transverse_around(const Model& model, const Vector3d& a) {
  std::vector<Parameter> parameters = {
      modulus_of(model, "k", "modulus added along the fibre", -2.0),
      modulus_of(model, "shear", "shear modulus added along the fibre", -0.95),
      modulus_of(model, "coupling", "modulus that couples strains along and across", -1e3)};
  for (const Parameter& angle : angles()) parameters.push_back(angle);
  return of_term(kTransverse, a, std::move(parameters), 3, [a](const VectorXd& v) {
    return orthotropic(
        orthotropic_values(transverse_stiffnesses(v), turned_frame(a, v[3], v[4], 0.0)));
  });
}

std::shared_ptr<const Ingredient> orthotropic_around(const Model& model, const Vector3d& a) {
  std::vector<Parameter> parameters;
  for (int k = 0; k < 8; ++k)
    parameters.push_back(modulus_of(model, kStiffness[k],
                                    fmt::format("stiffness {} added", kStiffness[k]),
                                    k < 3   ? -2.0
                                    : k < 6 ? -1e3
                                            : -0.95));
  for (const Parameter& angle : angles()) parameters.push_back(angle);
  parameters.push_back(
      {"anisotropy.angle3", "rad", "angle about the first axis", 0.0, -3.2, 3.2, 0.2, false});
  return of_term(kOrthotropic, a, std::move(parameters), 8, [a](const VectorXd& v) {
    return orthotropic(
        orthotropic_values(orthotropic_stiffnesses(v), turned_frame(a, v[8], v[9], v[10])));
  });
}

std::shared_ptr<const Ingredient> fibre_form(const Model& model, const std::string& variant) {
  const auto n = numbers_in(variant);
  if (n.size() != 3) return nullptr;
  const Vector3d a(n[0], n[1], n[2]);
  if (starts_with(variant, kPullingAlong)) return pulling_along(model, a);
  if (starts_with(variant, kPulling) || starts_with(variant, kPullingVolume))
    return pulling_around(model, a, starts_with(variant, kPullingVolume));
  if (starts_with(variant, kTransverse)) return transverse_around(model, a);
  return starts_with(variant, kOrthotropic) ? orthotropic_around(model, a) : nullptr;
}

std::vector<Effect::Further> further_fibres(const Model& model, const Ingredient& refitted,
                                            const VectorXd& values) {
  if (additive_base(model)) return {};
  if (starts_with(refitted.variant(), "free around"))
    return after_fibre(model, values, rounded(turned(base_axis(refitted), values[1], values[2])));
  if (starts_with(refitted.variant(), kPulling))
    return {{pulling_around(model, rounded(base_axis(refitted)), true), values},
            {transverse_around(model, rounded(base_axis(refitted))), fibre_at_rest(values[0])}};
  if (starts_with(refitted.variant(), kOrthotropic))
    return after_orthotropic(model, values, base_axis(refitted));
  if (!starts_with(refitted.variant(), kTransverse)) return {};
  // In the plane across, the axes are anyone's: turned by 45 degrees they see another shear.
  const VectorXd x = transverse_stiffnesses(values);
  VectorXd start = VectorXd::Zero(11);
  start.head(8) = x.head(8);
  start.segment(8, 2) = values.tail(2);
  return {{orthotropic_around(model, rounded(base_axis(refitted))), start}};
}

std::string fibre_sentence(const Model& model, const Ingredient& ingredient,
                           const VectorXd& values) {
  const std::string variant = ingredient.variant();
  const std::string stress = model.scene->capture.units.stress();
  if (variant.find("pulling") != std::string::npos) {
    const bool free = values.size() == 4;
    Vector3d a = base_axis(ingredient);
    if (free) a = turned(a, values[2], values[3]);
    if (a.z() < 0.0) a = -a;
    // as a fibre's: 4 k1 against 3 mu, once it pulls
    const double change = 4.0 * values[0] / (3.0 * initial_shear_modulus(model.energy));
    return fmt::format(
        "fibres along {} that only pull: {} % stiffer there than across when stretched (fibre "
        "modulus {} {}{})",
        vector_text(a), figure(100.0 * change), figure(values[0]), stress,
        free ? ", exponent " + figure(values[1]) : "");
  }
  if (starts_with(variant, kTransverse))
    return constants_text(model, transverse_stiffnesses(values),
                          turned_frame(base_axis(ingredient), values[3], values[4], 0.0));
  if (starts_with(variant, kOrthotropic))
    return constants_text(model, orthotropic_stiffnesses(values),
                          turned_frame(base_axis(ingredient), values[8], values[9], values[10]));
  return {};
}

}  // namespace hookeye
