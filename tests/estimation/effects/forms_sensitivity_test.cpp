// Derivatives of the forms that a refit has or goes on to, against equilibria solved again.
#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "estimation/effects/catalogue.h"
#include "estimation/solved_sensitivity.h"

namespace hookeye::test {

namespace {

/// The first `most` parameters of a form at values away from the null, as part of the model. How
/// many of them move something.
int check_form(const std::shared_ptr<const Ingredient>& ingredient, const VectorXd& values,
               size_t most = 100) {
  const ModelForm form = extended(base_form(block_scene()), ingredient);
  const VectorXd p = with_values(form, values);
  const States start = solve(form, p, {});
  if (::testing::Test::HasFailure()) return 0;
  const Evaluation evaluation = evaluated(form, p, {});
  const auto parameters = ingredient->parameters();
  const int first = form.size() - static_cast<int>(parameters.size());
  int moving = 0;
  for (size_t i = 0; i < std::min(most, parameters.size()); ++i) {
    const int k = first + static_cast<int>(i);
    const double h = 1e-3 * (parameters[i].positive ? p[k] : parameters[i].typical);
    moving +=
        expect_same(evaluation, k, solved_sensitivity(form, p, k, h, false, start), h, 1e-3,
                    ingredient->name() + " [" + ingredient->variant() + "] " + parameters[i].name);
  }
  return moving;
}

/// Forms of the refit at values away from the null, as part of the model.
TEST(Sensitivity, RefitForms) {
  const ModelForm base = base_form(block_scene());
  const Model model = with_states(base.realise(base.initial()));
  int tried = 0;
  for (const Effect* effect : catalogue()) {
    std::set<std::string> seen;
    for (const auto& scored : effect->candidates(model, nullptr)) {
      const auto [larger, values, by_way_of, same_claim] =
          effect->refit_form(model, scored, some_values(*scored));
      if (effect->remeshes(larger->variant())) continue;  // lives on another mesh: below
      // one free form a kind: the fibre's 24 bases are alike
      if (larger == scored || !seen.insert(larger->variant().substr(0, 12)).second) continue;
      tried += check_form(larger, values);
      if (const auto smaller = effect->form_from(FormEdge::smaller, model, *larger, values))
        tried += check_form(smaller->form, smaller->values);
      if (::testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(tried, 15);
}

/// A wall oblique to all axes that the bent block leans on, soft or hard: place, stiffness and both
/// tilts, away from no tilt.
TEST(Sensitivity, AnObliqueWallInAllItsNumbers) {
  const ModelForm base = base_form(block_scene());
  const Model model = with_states(base.realise(base.initial()));
  const Effect& effect = *find_effect("floor_contact");
  const auto scored = effect.candidate(model, "plane towards (0.8, 0.53, 0.29), position 25");
  ASSERT_NE(scored, nullptr);
  NextForm cushion = effect.refit_form(model, scored, VectorXd::Constant(1, 2e-4));
  ASSERT_EQ(cushion.values.size(), 4);
  cushion.values.tail<2>() << 0.06, -0.04;
  EXPECT_EQ(check_form(cushion.form, cushion.values), 4);
  const auto hard = effect.form_from(FormEdge::smaller, model, *cushion.form, cushion.values);
  ASSERT_TRUE(hard);
  EXPECT_EQ(check_form(hard->form, hard->values), 3);
}

/// Forms that a refit goes on to, away from their nulls; of a field's bumps the first stand for
/// all.
void check_further_forms(const std::string& name, int least) {
  const ModelForm base = base_form(block_scene());
  const Model model = base.realise(base.initial());
  const Effect& effect = *find_effect(name);
  const auto scored = effect.candidates(model, nullptr).front();
  const NextForm refitted = effect.refit_form(model, scored, some_values(*scored));
  int moving = 0;
  std::set<std::string> seen;
  const std::function<void(const Ingredient&, const VectorXd&)> follow = [&](const Ingredient& from,
                                                                             const VectorXd& at) {
    for (const auto& further : effect.forms_from(FormEdge::further, model, from, at)) {
      const VectorXd some = some_values(*further.form);
      // one a kind: forms around other directions are alike
      const std::string variant = further.form->variant();
      if (!seen.insert(variant.substr(0, variant.find('('))).second) continue;
      moving += check_form(further.form, some, 12);
      if (::testing::Test::HasFailure()) return;
      follow(*further.form, some);
    }
    if (const auto plainer = effect.form_from(FormEdge::plainer, model, from, at))
      moving += check_form(plainer->form, some_values(*plainer->form), 12);
  };
  follow(*refitted.form, refitted.values);
  if (const auto smaller =
          effect.form_from(FormEdge::smaller, model, *refitted.form, refitted.values))
    follow(*smaller->form, some_values(*smaller->form));
  EXPECT_GE(moving, least);
}

TEST(Sensitivity, FurtherFormsOfAnisotropy) { check_further_forms("anisotropy", 44); }
TEST(Sensitivity, FurtherFormsOfCreep) { check_further_forms("creep", 4); }
TEST(Sensitivity, FurtherFormsOfSwelling) { check_further_forms("swelling", 16); }
TEST(Sensitivity, FurtherFormsOfStiffness) { check_further_forms("stiffness_field", 15); }

}  // namespace

}  // namespace hookeye::test
