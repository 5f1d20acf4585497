// One contract for the whole catalogue (style.md): null is bit-equal, derivatives are there and
// converge, bounds mean what they say, variants rebuild, forces turn with the set-up.
#include <gmock/gmock.h>

#include <regex>
#include <set>

#include "estimation/diagnosis/diagnosis.h"
#include "estimation/effects/catalogue.h"
#include "estimation/effects/toolbox.h"
#include "estimation/effects_scene.h"
#include "estimation/evaluation/evaluation.h"
#include "simulation/equilibrium.h"

namespace hookeye::test {

namespace {

struct Case {
  const Effect* effect;
  std::shared_ptr<const Ingredient> ingredient;
  std::string label() const { return effect->name() + " [" + ingredient->variant() + "]"; }
};

std::vector<std::string> names(const Ingredient& ingredient) {
  std::vector<std::string> out;
  for (const Parameter& parameter : ingredient.parameters()) out.push_back(parameter.name);
  return out;
}

/// Adds the further forms of `refitted`, the plainer one, and theirs; one a kind: those around
/// other directions are alike.
void add_further(const Effect& effect, const Ingredient& refitted, std::set<std::string>& kinds,
                 std::vector<Case>& all) {
  for (const auto& further :
       effect.forms_from(FormEdge::further, base_model(), refitted, some_values(refitted))) {
    EXPECT_EQ(further.values.size(), static_cast<int>(further.form->parameters().size()));
    if (further.by_way_of) {
      EXPECT_EQ(names(*further.by_way_of), names(*further.form));
      EXPECT_TRUE(effect.candidate(base_model(), further.by_way_of->variant()));
    }
    const std::string variant = further.form->variant();
    if (!kinds.insert(variant.substr(0, variant.find('('))).second) continue;
    all.push_back({&effect, further.form});
    add_further(effect, *further.form, kinds, all);
  }
  if (const auto plainer =
          effect.form_from(FormEdge::plainer, base_model(), refitted, some_values(refitted))) {
    EXPECT_EQ(plainer->values.size(), static_cast<int>(plainer->form->parameters().size()));
    all.push_back({&effect, plainer->form});
  }
}

/// Candidates and, after each, the forms that it is refitted with; of an effect's first, the
/// further ones.
std::vector<Case> all_cases(bool refit_forms) {
  std::vector<Case> all;
  for (const Effect* effect : catalogue()) {
    std::set<std::string> seen;
    for (const auto& one : effect->candidates(base_model(), nullptr)) {
      all.push_back({effect, one});
      if (!refit_forms) continue;
      const NextForm refit = effect->refit_form(base_model(), one, some_values(*one));
      const auto& larger = refit.form;
      EXPECT_EQ(refit.values.size(), static_cast<int>(larger->parameters().size()));
      const bool first = seen.empty();
      std::set<std::string> kinds;
      if (seen.insert(larger->variant()).second && larger != one) all.push_back({effect, larger});
      if (first) add_further(*effect, *larger, kinds, all);
    }
  }
  return all;
}

bool has_null(const Ingredient& ingredient) {
  return ingredient.variant().rfind("springs", 0) != 0 &&
         ingredient.variant().rfind("hard", 0) != 0 &&
         ingredient.variant().rfind("cushion", 0) != 0;
}

TEST(Catalogue, NamesAreThoseOfTheFormat) {
  std::vector<std::string> names;
  for (const Effect* effect : catalogue()) names.push_back(effect->name());
  EXPECT_THAT(names, ::testing::IsSupersetOf({"strain_stiffening", "compressibility",
                                              "anisotropy",        "tension_compression_asymmetry",
                                              "stiffness_field",   "gravity",
                                              "swelling",          "load_direction",
                                              "pressure",          "placement",
                                              "soft_clamp",        "grip_slip",
                                              "floor_contact",     "creep",
                                              "softening",         "camera_pose",
                                              "focal_length",      "exposure",
                                              "light_direction",   "defocus",
                                              "specular",          "force_zero",
                                              "mesh_resolution"}));
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  for (const auto& name : names) EXPECT_EQ(find_effect(name)->name(), name);
  EXPECT_EQ(find_effect("no_such_effect"), nullptr);
}

TEST(Catalogue, EveryEffectAppliesToTheBlockAndStaysSmall) {
  int columns = 0;
  for (const Effect* effect : catalogue()) {
    std::string why_not;
    const auto candidates = effect->candidates(base_model(), &why_not);
    EXPECT_FALSE(candidates.empty()) << effect->name() << ": " << why_not;
    std::set<std::string> variants;
    for (const auto& one : candidates) {
      columns += static_cast<int>(one->parameters().size());
      EXPECT_EQ(one->name(), effect->name());
      EXPECT_TRUE(variants.insert(one->variant()).second)
          << effect->name() << " has two of " << one->variant();
    }
  }
  RecordProperty("columns", columns);
  EXPECT_LT(columns, 300);
}

TEST(Catalogue, WordsAreThere) {
  for (const Case& c : all_cases(true)) {
    EXPECT_FALSE(c.effect->title().empty());
    EXPECT_GT(c.effect->manual().size(), 80u) << c.label();
    const std::string text =
        c.effect->sentence(base_model(), *c.ingredient, some_values(*c.ingredient));
    EXPECT_GT(text.size(), 15u) << c.label();
    EXPECT_EQ(text.find("nan"), std::string::npos) << text;
    EXPECT_FALSE(
        c.effect->sentence(base_model(), *c.ingredient, null_values(*c.ingredient)).empty());
  }
}

TEST(Catalogue, ParametersAreDeclaredWhole) {
  const std::regex unit("(rad|px\\^2|mm|N|MPa|MPa/mm|mm/MPa|mm/s\\^2|N/mm\\^3)?");
  for (const Case& c : all_cases(true)) {
    std::set<std::string> names;
    for (const Parameter& p : c.ingredient->parameters()) {
      EXPECT_TRUE(names.insert(p.name).second) << p.name;
      EXPECT_EQ(p.name.rfind(c.effect->name() + ".", 0), 0u) << p.name;
      EXPECT_TRUE(std::regex_match(p.unit, unit)) << c.label() << " " << p.unit;
      EXPECT_FALSE(p.long_name.empty()) << p.name;
      EXPECT_GT(p.typical, 0.0) << p.name;
      EXPECT_LE(p.low, p.value) << p.name;
      EXPECT_GE(p.high, p.value) << p.name;
      if (p.positive) {
        EXPECT_GT(p.value, 0.0) << p.name;
      }
    }
  }
}

TEST(Catalogue, OneSidedEffectsSaySo) {
  const std::set<std::string> expected = {
      "anisotropy", "soft_clamp", "grip_slip", "floor_contact",   "creep",
      "softening",  "defocus",    "specular",  "mesh_resolution", "strain_stiffening"};
  std::set<std::string> one_sided;
  for (const Case& c : all_cases(false))
    for (const Parameter& p : c.ingredient->parameters())
      if (p.low == p.value || p.high == p.value) one_sided.insert(c.effect->name());
  EXPECT_EQ(one_sided, expected);
}

/// By it the derivative skips what does not change, and the mesh's error, which moves the body, is
/// not laid to what changes brightness alone.
TEST(Catalogue, TouchesSayWhatChangesInPhotos) {
  std::set<std::string> brightness;
  for (const Case& c : all_cases(true)) {
    const ModelForm form = extended(base(), c.ingredient);
    VectorXd p = form.initial();
    p.tail(static_cast<Eigen::Index>(c.ingredient->parameters().size())) =
        some_values(*c.ingredient);
    const Model model = form.realise(p);
    bool moves = !model.placement.isApprox(base_model().placement, 1e-15), shades = false;
    for (size_t e = 0; e < model.examples.size(); ++e)
      for (size_t k = 0; k < model.examples[e].photos.size(); ++k) {
        const VectorXd d =
            photo_difference(base_model().examples[e].photos[k], model.examples[e].photos[k]);
        moves = moves || !d.head(kLogGain).isZero(0.0);
        shades = shades || !d.tail(kPhotoNumbers - kLogGain).isZero(0.0);
      }
    const Touches touches = c.ingredient->touches();
    EXPECT_EQ(touches.cameras, moves) << c.label();
    EXPECT_EQ(touches.photos, moves || shades) << c.label();
    if (brightness_alone(*c.ingredient)) brightness.insert(c.effect->name());
  }
  EXPECT_EQ(brightness,
            (std::set<std::string>{"defocus", "exposure", "light_direction", "specular"}));
}

TEST(Catalogue, NullLeavesTheModelBitEqual) {
  const VectorXd q = deformed_state(*block_scene());
  const VectorXd before = signature(base_model(), q);
  const double energy_before = internal_energy(block_scene()->body->mesh, base_model().energy, q);
  for (const Case& c : all_cases(true)) {
    if (!has_null(*c.ingredient)) continue;
    const ModelForm form = extended(base(), c.ingredient);
    const Model model = form.realise(form.initial());
    const VectorXd after = signature(model, q);
    ASSERT_EQ(after.size(), before.size()) << c.label();
    EXPECT_TRUE(after == before) << c.label() << ": differs by " << (after - before).norm();
    EXPECT_EQ(internal_energy(model.scene->body->mesh, model.energy, q), energy_before)
        << c.label();
  }
}

/// Second-order difference of the signature, one-sided at a bound.
VectorXd difference(const ModelForm& form, const VectorXd& p, int k, double h, bool one_sided,
                    const VectorXd& q) {
  auto at = [&](double shift) {
    VectorXd moved = p;
    moved[k] += shift;
    return signature(form.realise(moved), q);
  };
  if (one_sided) return (-1.5 * at(0.0) + 2.0 * at(h) - 0.5 * at(2 * h)) / h;
  return (at(h) - at(-h)) / (2.0 * h);
}

TEST(Catalogue, DerivativesAreThereAndConvergeWithSecondOrder) {
  const VectorXd q = deformed_state(*block_scene());
  for (const Case& c : all_cases(true)) {
    if (c.effect->name() == "soft_clamp") continue;  // changes what is prescribed: next test
    const ModelForm form = extended(base(), c.ingredient);
    const bool refit =
        c.ingredient->parameters().size() > 1 && c.ingredient->variant().rfind("free", 0) == 0;
    // centre, radius and angles of a free form mean nothing while its strength is null
    const VectorXd p =
        with_values(form, refit ? some_values(*c.ingredient) : null_values(*c.ingredient));
    const auto parameters = c.ingredient->parameters();
    for (size_t i = 0; i < parameters.size(); ++i) {
      const int k = base().size() + static_cast<int>(i);
      // A hundredth of the depth over which a plane's force sets in: beyond it no order holds, as
      // points of the body pass from nothing to that and on.
      const bool sets_in =
          c.effect->name() == "floor_contact" && parameters[i].name != "floor_contact.k";
      const double h = (sets_in ? 5e-4 : 0.02) * parameters[i].typical;
      const bool one_sided = p[k] - h < parameters[i].low;
      const VectorXd d1 = difference(form, p, k, h, one_sided, q);
      const VectorXd d2 = difference(form, p, k, h / 2, one_sided, q);
      const VectorXd d4 = difference(form, p, k, h / 4, one_sided, q);
      // a plane that this state does not reach, or fibres that it does not stretch, have none here
      const bool pulls = c.ingredient->variant().find("pulling") != std::string::npos;
      if ((c.effect->name() == "floor_contact" || pulls) && d4.norm() == 0.0) continue;
      EXPECT_GT(d4.norm(), 0.0) << c.label() << " " << parameters[i].name;
      const double coarse = (d1 - d2).norm(), fine = (d2 - d4).norm();
      const double rounding =
          std::max(1e-9 * d4.norm(), 1e-13 * signature(base_model(), q).norm() / h);
      // Where fibres begin to pull the third derivative jumps: better than first order, not second.
      const bool jumps = c.ingredient->variant().rfind("free pulling", 0) == 0;
      EXPECT_LT(fine, std::max((jumps ? 0.5 : 0.35) * coarse, rounding))
          << c.label() << " " << parameters[i].name << ": " << coarse << " then " << fine;
    }
  }
}

TEST(Catalogue, VariantsRebuild) {
  const VectorXd q = deformed_state(*block_scene());
  for (const Case& c : all_cases(true)) {
    const auto again = c.effect->candidate(base_model(), c.ingredient->variant());
    ASSERT_NE(again, nullptr) << c.label();
    EXPECT_EQ(again->variant(), c.ingredient->variant());
    const VectorXd values = some_values(*c.ingredient);
    ASSERT_EQ(again->parameters().size(), c.ingredient->parameters().size()) << c.label();
    const ModelForm first = extended(base(), c.ingredient), second = extended(base(), again);
    const VectorXd a = signature(first.realise(with_values(first, values)), q);
    const VectorXd b = signature(second.realise(with_values(second, values)), q);
    ASSERT_EQ(a.size(), b.size()) << c.label();
    // Bit-equal, but for an effect that solves equilibria: they start where its last ones were, and
    // end within their tolerance.
    const double tolerance = c.effect->name() == "mesh_resolution" ? 1e-6 * a.norm() : 0.0;
    EXPECT_LE((a - b).norm(), tolerance) << c.label();
    EXPECT_EQ(c.effect->candidate(base_model(), "no such variant"), nullptr) << c.label();
  }
}

/// The variant and values of the same hypothesis on the turned set-up, where they have directions.
bool turn_case(const Case& c, std::string& variant, VectorXd& values) {
  const std::string name = c.effect->name();
  auto turn_vector = [&] {
    values = VectorXd(quarter_turn(Vector3d(values[0], values[1], values[2])));
  };
  std::smatch match;
  static const std::regex triple("\\(([-0-9.e]+), ([-0-9.e]+), ([-0-9.e]+)\\)");
  if (name == "gravity" || (name == "load_direction" && values.size() == 3)) {
    turn_vector();
  } else if (name == "load_direction" || name == "floor_contact") {
    return false;  // axes and sides are chosen anew
  } else if (variant.rfind("along", 0) == 0 || variant.rfind("pulling along", 0) == 0 ||
             variant.rfind("blob", 0) == 0 || variant.rfind("halves", 0) == 0) {
    if (!std::regex_search(variant, match, triple)) return false;
    variant = match.prefix().str() + "(-" + match[2].str() + ", " + match[1].str() + ", " +
              match[3].str() + ")" + match.suffix().str();
    const size_t twice = variant.find("(--");
    if (twice != std::string::npos) variant.erase(twice + 1, 2);
  } else if (variant.rfind("field", 0) == 0 || variant.rfind("free", 0) == 0) {
    return false;  // covered by the blobs and fibres
  }
  return true;
}

TEST(Catalogue, ForcesTurnWithTheSetUp) {
  const ModelForm turned_base = base_form(turned_scene());
  const Model turned_model = turned_base.realise(turned_base.initial());
  const VectorXd q = deformed_state(*block_scene()), q_turned = deformed_state(*turned_scene());
  int tried = 0;
  for (const Case& c : all_cases(true)) {
    if (c.effect->group() == EffectGroup::measurement || c.effect->name() == "placement") continue;
    // a turned surface is filled with other tetrahedra
    if (c.effect->group() == EffectGroup::numerical) continue;
    std::string variant = c.ingredient->variant();
    const VectorXd values = some_values(*c.ingredient);
    VectorXd values_turned = values;
    if (!turn_case(c, variant, values_turned)) continue;
    const auto turned = c.effect->candidate(turned_model, variant);
    ASSERT_NE(turned, nullptr) << c.label() << " as " << variant;
    const ModelForm form = extended(base(), c.ingredient);
    const ModelForm form_turned = extended(turned_base, turned);
    const Model m = form.realise(with_values(form, values));
    const Model m_turned = form_turned.realise(with_values(form_turned, values_turned));
    for (size_t e = 0; e < m.examples.size(); ++e) {
      const int i = static_cast<int>(e);
      const VectorXd R = residual(m.scene->body->mesh, m.energy_of(i), m.examples[e].loading, q);
      const VectorXd R_turned = residual(m_turned.scene->body->mesh, m_turned.energy_of(i),
                                         m_turned.examples[e].loading, q_turned);
      VectorXd expected(R.size());
      for (int a = 0; 3 * a < R.size(); ++a)
        expected.segment<3>(3 * a) = quarter_turn(R.segment<3>(3 * a));
      EXPECT_LT((R_turned - expected).norm(), 1e-10 * R.norm()) << c.label() << " example " << e;
    }
    ++tried;
  }
  EXPECT_GT(tried, 40);
}

/// With one value off its null, what is left of it in fewer parameters is the same model.
TEST(Catalogue, SmallerFormsSayTheSameWhereOneValueStandsOut) {
  const VectorXd q = deformed_state(*block_scene());
  int tried = 0;
  for (const Case& c : all_cases(true)) {
    const VectorXd nulls = null_values(*c.ingredient);
    for (Eigen::Index k = 0; k < nulls.size(); ++k) {
      VectorXd values = nulls;
      values[k] = some_values(*c.ingredient)[k];
      const auto next = c.effect->form_from(FormEdge::smaller, base_model(), *c.ingredient, values);
      if (!next) break;
      const auto& [smaller, fewer, by_way_of, same_claim] = *next;
      if (c.ingredient->variant().rfind("cushion", 0) == 0) {
        // a hard floor is the cushion that is as stiff as it says, 3e4 times the declared
        values[1] = numbers_in(smaller->variant()).back();
        EXPECT_NEAR(values[1], 3e4 * nulls[1], 3.0 * nulls[1]);  // five digits
      }
      EXPECT_LT(smaller->parameters().size(), c.ingredient->parameters().size()) << c.label();
      const ModelForm form = extended(base(), c.ingredient), other = extended(base(), smaller);
      const VectorXd expected = signature(form.realise(with_values(form, values)), q);
      const VectorXd found = signature(other.realise(with_values(other, fewer)), q);
      EXPECT_LT((found - expected).norm(), 1e-9 * expected.norm()) << c.label() << " value " << k;
      ++tried;
    }
  }
  EXPECT_GT(tried, 0);
}

}  // namespace

}  // namespace hookeye::test
