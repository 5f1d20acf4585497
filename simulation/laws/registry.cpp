// The laws by name. A new law: write simulation/laws/NAME.cpp, declare its function in
// energy_term.h, and add one entry to `known_laws()` below; docs and messages follow from it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>

#include "simulation/additive.h"
#include "simulation/laws/material_frame.h"

namespace hookeye {
namespace {

struct Key {
  enum class Kind { positive, not_negative, any, list };
  std::string name;
  Kind kind;
  bool needed = true;
};

using Values = std::map<std::string, MaterialSpec::Value>;

/// What is wrong with the values together, and the key that shows it.
struct Fault {
  std::string key, wrong, right;
};

/// One way to write a law: its keys; `check` looks at them together.
struct Form {
  std::string law;
  std::vector<Key> keys;
  std::function<std::shared_ptr<const EnergyTerm>(const Values&)> make;
  std::function<std::optional<Fault>(const Values&)> check = nullptr;
  /// A law whose keys are the user's own reads and checks them itself.
  std::function<std::shared_ptr<const EnergyTerm>(const MaterialSpec&)> read = nullptr;
};

const std::vector<double>& numbers(const Values& v, const char* key) { return v.at(key).numbers; }
double number(const Values& v, const char* key) { return numbers(v, key)[0]; }

std::optional<Fault> check_ogden(const Values& v) {
  const auto &mu = numbers(v, "mu"), &alpha = numbers(v, "alpha");
  if (mu.size() != alpha.size())
    return Fault{"alpha",
                 fmt::format("{} moduli `mu` but {} exponents `alpha`", mu.size(), alpha.size()),
                 "one exponent for every modulus"};
  double shear = 0;
  for (size_t i = 0; i < mu.size(); ++i) {
    if (alpha[i] == 0)
      return Fault{"alpha", fmt::format("exponent {} of `alpha` is 0", i + 1),
                   "any other number; 2 alone is neo-Hooke"};
    shear += 0.5 * mu[i] * alpha[i];
  }
  if (shear > 0) return {};
  return Fault{
      "mu",
      fmt::format("the small-strain shear modulus, sum of mu_i alpha_i / 2, is {:.4g}", shear),
      "a sum above 0: a modulus has the sign of its exponent"};
}

std::optional<Fault> check_mooney(const Values& v) {
  const double shear = 2 * (number(v, "c10") + number(v, "c01"));
  if (shear > 0) return {};
  return Fault{number(v, "c10") < number(v, "c01") ? "c10" : "c01",
               fmt::format("the small-strain shear modulus 2 (c10 + c01) is {:.4g}", shear),
               "a sum above 0"};
}

using Vector9d = Eigen::Matrix<double, 9, 1>;

std::optional<Fault> check_fung(const Values& v) {
  const auto& b = numbers(v, "b");
  if (b.size() != 9)
    return Fault{"b", fmt::format("`b` has {} numbers", b.size()),
                 "9 numbers: b11 b22 b33 b12 b23 b13 g12 g23 g13"};
  Matrix3d B;
  B << b[0], b[3], b[5], b[3], b[1], b[4], b[5], b[4], b[2];
  if (Eigen::LLT<Matrix3d>(B).info() != Eigen::Success)
    return Fault{"b", "the matrix (b11 b12 b13; b12 b22 b23; b13 b23 b33) is not positive definite",
                 "larger b11, b22, b33 or smaller b12, b23, b13"};
  if (!(b[6] > 0 && b[7] > 0 && b[8] > 0))
    return Fault{"b", "a shear coefficient g12, g23, g13 is not above 0", "three numbers above 0"};
  return {};
}

std::optional<Fault> check_holzapfel(const Values& v) {
  const auto dispersion = v.find("dispersion"), toe = v.find("toe"), rows = v.find("directions");
  if (dispersion != v.end() &&
      !(number(v, "dispersion") >= 0 && number(v, "dispersion") <= 1.0 / 3))
    return Fault{"dispersion", fmt::format("`dispersion` is {}", number(v, "dispersion")),
                 "a number from 0 (all fibres along their direction) to 1/3 (along all alike)"};
  if (toe != v.end() && !(number(v, "toe") > 0 && number(v, "toe") < 1))
    return Fault{"toe", fmt::format("`toe` is {}", number(v, "toe")),
                 "a strain above 0 and below 1; 0.01 where it is left out"};
  if (v.count("frame.axis") != v.count("frame.center"))
    return Fault{v.count("frame.axis") ? "frame.axis" : "frame.center",
                 "a tube's frame needs its axis and its center",
                 "`frame: {axis: [0, 0, 1], center: [0, 0, 0]}`"};
  if (rows == v.end()) return {};
  const auto& d = rows->second.numbers;
  if (d.size() % 3 != 0)
    return Fault{"directions", fmt::format("`directions` has {} numbers", d.size()),
                 "three for every family of fibres: [[1, 0, 0], [0, 1, 0]]"};
  for (size_t i = 0; i < d.size(); i += 3)
    if (!(Eigen::Vector3d(d[i], d[i + 1], d[i + 2]).norm() > 0))
      return Fault{"directions", fmt::format("direction {} has no length", i / 3 + 1),
                   "a direction in the material frame: [1, 0, 0]"};
  return {};
}

std::shared_ptr<const EnergyTerm> make_holzapfel(const Values& v) {
  HolzapfelValues out;
  out.mu = number(v, "mu"), out.kappa = number(v, "kappa");
  out.k1 = number(v, "k1"), out.k2 = number(v, "k2");
  if (v.count("dispersion")) out.dispersion = number(v, "dispersion");
  if (v.count("toe")) out.toe = number(v, "toe");
  Matrix3d axes = Matrix3d::Identity();
  if (v.count("frame")) axes = laws::read_frame(v.at("frame"));
  out.frame = axes;
  if (v.count("frame.axis")) {
    out.cylinder = laws::read_cylinder(v.at("frame.axis"), v.at("frame.center"));
    // The wall of a tube: axes 2 (around) and 3 (along) are its plane.
    out.frame << Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX();
  }
  if (v.count("angles")) {
    out.angles = numbers(v, "angles");
  } else {
    const auto& d = numbers(v, "directions");
    for (size_t i = 0; i < d.size(); i += 3)
      out.directions.push_back(axes * Eigen::Vector3d(d[i], d[i + 1], d[i + 2]).normalized());
  }
  return holzapfel(out);
}

std::vector<Key> holzapfel_keys(const char* fibres) {
  using K = Key::Kind;
  return {{"mu", K::positive},
          {"k1", K::positive},
          {"k2", K::positive},
          {fibres, K::list},
          {"kappa", K::positive},
          {"dispersion", K::any, false},
          {"toe", K::any, false},
          {"frame", K::list, false},
          {"frame.axis", K::list, false},
          {"frame.center", K::list, false}};
}

const std::vector<Form>& known_laws() {
  using K = Key::Kind;
  static const std::vector<Form> forms = {
      {"neo-hookean",
       {{"mu", K::positive}, {"kappa", K::positive}},
       [](const Values& v) { return neo_hookean(number(v, "mu"), number(v, "kappa")); }},
      {"neo-hookean",
       {{"mu", K::positive}, {"kappa_over_mu", K::positive}},
       [](const Values& v) {
         return neo_hookean_tied(number(v, "mu"), number(v, "kappa_over_mu"));
       }},
      {"stvk",
       {{"lambda", K::not_negative}, {"mu", K::positive}},
       [](const Values& v) { return stvk(number(v, "lambda"), number(v, "mu")); }},
      {"mooney-rivlin",
       {{"c10", K::any}, {"c01", K::any}, {"kappa", K::positive}},
       [](const Values& v) {
         return mooney_rivlin(number(v, "c10"), number(v, "c01"), number(v, "kappa"));
       },
       check_mooney},
      {"yeoh",
       {{"c1", K::positive}, {"c2", K::any}, {"c3", K::any}, {"kappa", K::positive}},
       [](const Values& v) {
         return yeoh(number(v, "c1"), number(v, "c2"), number(v, "c3"), number(v, "kappa"));
       }},
      {"ogden",
       {{"mu", K::list}, {"alpha", K::list}, {"kappa", K::positive}},
       [](const Values& v) {
         return ogden(numbers(v, "mu"), numbers(v, "alpha"), number(v, "kappa"));
       },
       check_ogden},
      {"fung",
       {{"c", K::positive}, {"b", K::list}, {"kappa", K::positive}},
       [](const Values& v) {
         return fung(number(v, "c"), Eigen::Map<const Vector9d>(numbers(v, "b").data()),
                     number(v, "kappa"));
       },
       check_fung},
      {"holzapfel", holzapfel_keys("angles"), make_holzapfel, check_holzapfel},
      {"holzapfel", holzapfel_keys("directions"), make_holzapfel, check_holzapfel},
      {"additive",
       {{"E11: {at: [...], stiffness: [...]}, ...", K::list}},
       nullptr,
       nullptr,
       [](const MaterialSpec& spec) { return additive(read_additive(spec)); }},
  };
  return forms;
}

std::string usage(const Form& form) {
  std::vector<std::string> keys, optional;
  for (const Key& k : form.keys)
    if (k.needed)
      keys.push_back(k.name + (k.kind == Key::Kind::list && !form.read ? ": [...]" : ""));
    else if (k.name.find('.') == std::string::npos)
      optional.push_back(k.name);
  return fmt::format("{} {{{}}}{}{}", form.law, fmt::join(keys, ", "),
                     optional.empty() ? "" : " and if wanted ", fmt::join(optional, ", "));
}

/// All ways to write the law, or of all laws.
std::string usages(const std::string& law) {
  std::vector<std::string> all;
  for (const Form& f : known_laws())
    if (law.empty() || f.law == law) all.push_back(usage(f));
  return fmt::format("{}", fmt::join(all, " or "));
}

bool has_key(const Form& form, const std::string& name) {
  for (const Key& k : form.keys)
    if (k.name == name) return true;
  return false;
}

/// The form of the law that shares most keys with the spec (the first of equals).
const Form& best_form(const MaterialSpec& spec) {
  const Form* best = nullptr;
  int most = -1;
  for (const Form& f : known_laws()) {
    if (f.law != spec.law) continue;
    int shared = 0;
    for (const Key& k : f.keys) shared += static_cast<int>(spec.parameters.count(k.name));
    if (shared > most) {
      most = shared;
      best = &f;
    }
  }
  if (best) return *best;
  const std::string near = nearest_name(spec.law, law_names());
  throw InputError(spec.place, fmt::format("there is no law `{}`", spec.law),
                   near.empty() ? "one of " + usages("") : fmt::format("did you mean `{}`?", near));
}

void check_keys(const MaterialSpec& spec, const Form& form) {
  std::vector<std::string> names;
  for (const Form& f : known_laws())
    if (f.law == spec.law)
      for (const Key& k : f.keys) names.push_back(k.name);
  for (const auto& [name, value] : spec.parameters) {
    if (has_key(form, name)) continue;
    const std::string near = nearest_name(name, names);
    const bool other_form = std::find(names.begin(), names.end(), name) != names.end();
    throw InputError(
        value.place,
        other_form ? fmt::format("`{}` does not go with the other parameters", name)
                   : fmt::format("the law {} has no parameter `{}`", spec.law, name),
        near.empty() || other_form ? usages(spec.law) : fmt::format("did you mean `{}`?", near));
  }
  for (const Key& k : form.keys)
    if (k.needed && !spec.parameters.count(k.name))
      throw InputError(spec.place, fmt::format("the law {} lacks `{}`", spec.law, k.name),
                       usages(spec.law));
}

void check_value(const MaterialSpec& spec, const Key& key) {
  const MaterialSpec::Value& value = spec.parameters.at(key.name);
  const auto& x = value.numbers;
  if (key.kind == Key::Kind::list ? x.empty() : x.size() != 1)
    throw InputError(value.place, fmt::format("`{}` has {} numbers", key.name, x.size()),
                     key.kind == Key::Kind::list ? "one or more numbers in [ ]" : "one number");
  for (double v : x) {
    if (!std::isfinite(v))
      throw InputError(value.place, fmt::format("`{}` is {}", key.name, v), "a finite number");
    if (key.kind == Key::Kind::positive && !(v > 0))
      throw InputError(value.place, fmt::format("`{}` is {}", key.name, v), "a number above 0");
    if (key.kind == Key::Kind::not_negative && !(v >= 0))
      throw InputError(value.place, fmt::format("`{}` is {}", key.name, v), "a number, 0 or above");
  }
}

}  // namespace

std::shared_ptr<const EnergyTerm> make_law(const MaterialSpec& spec) {
  const Form& form = best_form(spec);
  if (form.read) return form.read(spec);
  check_keys(spec, form);
  for (const Key& k : form.keys)
    if (spec.parameters.count(k.name)) check_value(spec, k);
  if (form.check)
    if (const auto fault = form.check(spec.parameters))
      throw InputError(spec.parameters.at(fault->key).place, fault->wrong, fault->right);
  return form.make(spec.parameters);
}

std::vector<std::string> law_names() {
  std::vector<std::string> names;
  for (const Form& f : known_laws())
    if (std::find(names.begin(), names.end(), f.law) == names.end()) names.push_back(f.law);
  return names;
}

}  // namespace hookeye
