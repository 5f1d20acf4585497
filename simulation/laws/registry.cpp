// The laws by name. A new law: write simulation/laws/NAME.cpp, declare its function in
// energy_term.h, and add one entry to `known_laws()` below; docs and messages follow from it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>

#include "simulation/additive.h"

namespace hookeye {
namespace {

struct Key {
  enum class Kind { positive, not_negative, any, list };
  std::string name;
  Kind kind;
};

using Values = std::map<std::string, std::vector<double>>;

/// One way to write a law: its keys, all needed; `check` returns what is wrong ("" if nothing).
struct Form {
  std::string law;
  std::vector<Key> keys;
  std::function<std::shared_ptr<const EnergyTerm>(const Values&)> make;
  std::function<std::string(const Values&)> check = nullptr;
  /// A law whose keys are the user's own reads and checks them itself.
  std::function<std::shared_ptr<const EnergyTerm>(const MaterialSpec&)> read = nullptr;
};

double number(const Values& v, const char* key) { return v.at(key)[0]; }

std::string check_ogden(const Values& v) {
  const auto &mu = v.at("mu"), &alpha = v.at("alpha");
  if (mu.size() != alpha.size())
    return fmt::format("{} moduli `mu` but {} exponents `alpha`", mu.size(), alpha.size());
  double shear = 0;
  for (size_t i = 0; i < mu.size(); ++i) {
    if (alpha[i] == 0) return "an exponent `alpha` is 0";
    shear += 0.5 * mu[i] * alpha[i];
  }
  return shear > 0 ? ""
                   : "the small-strain shear modulus, sum of mu_i alpha_i / 2, is not positive";
}

std::string check_mooney(const Values& v) {
  return number(v, "c10") + number(v, "c01") > 0
             ? ""
             : "the small-strain shear modulus 2 (c10 + c01) is not positive";
}

using Vector9d = Eigen::Matrix<double, 9, 1>;

std::string check_fung(const Values& v) {
  const auto& b = v.at("b");
  if (b.size() != 9)
    return fmt::format("`b` has {} numbers, not 9: b11 b22 b33 b12 b23 b13 g12 g23 g13", b.size());
  Matrix3d B;
  B << b[0], b[3], b[5], b[3], b[1], b[4], b[5], b[4], b[2];
  if (Eigen::LLT<Matrix3d>(B).info() != Eigen::Success)
    return "the matrix (b11 b12 b13; b12 b22 b23; b13 b23 b33) is not positive definite";
  if (!(b[6] > 0 && b[7] > 0 && b[8] > 0))
    return "a shear coefficient g12, g23, g13 is not above 0";
  return "";
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
       [](const Values& v) { return ogden(v.at("mu"), v.at("alpha"), number(v, "kappa")); },
       check_ogden},
      {"fung",
       {{"c", K::positive}, {"b", K::list}, {"kappa", K::positive}},
       [](const Values& v) {
         return fung(number(v, "c"), Eigen::Map<const Vector9d>(v.at("b").data()),
                     number(v, "kappa"));
       },
       check_fung},
      {"additive",
       {{"E11: {at: [...], stiffness: [...]}, ...", K::list}},
       nullptr,
       nullptr,
       [](const MaterialSpec& spec) { return additive(read_additive(spec)); }},
  };
  return forms;
}

std::string usage(const Form& form) {
  std::vector<std::string> keys;
  for (const Key& k : form.keys)
    keys.push_back(k.name + (k.kind == Key::Kind::list && !form.read ? ": [...]" : ""));
  return fmt::format("{} {{{}}}", form.law, fmt::join(keys, ", "));
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
    if (!spec.parameters.count(k.name))
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
  Values values;
  for (const Key& k : form.keys) {
    check_value(spec, k);
    values[k.name] = spec.parameters.at(k.name).numbers;
  }
  if (form.check) {
    const std::string wrong = form.check(values);
    if (!wrong.empty()) throw InputError(spec.place, wrong, usages(spec.law));
  }
  return form.make(values);
}

std::vector<std::string> law_names() {
  std::vector<std::string> names;
  for (const Form& f : known_laws())
    if (std::find(names.begin(), names.end(), f.law) == names.end()) names.push_back(f.law);
  return names;
}

}  // namespace hookeye
