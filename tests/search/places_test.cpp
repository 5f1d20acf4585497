// Several places: beside one that stands another is found, as any effect is.
#include <gmock/gmock.h>

#include "estimation/effects/catalogue.h"
#include "estimation/fit/at_floor.h"
#include "estimation/search/refit.h"
#include "tests/search/hiding.h"

namespace hookeye {
namespace {

TEST(Places, ASecondIsFoundBesideTheFirst) {
  const test::SmallScene small(
      {.hidden = "hidden:\n  - {effect: stiffness_field, variant: free ball, values: "
                 "{stiffness_field.a: -1.5, stiffness_field.x: 3, stiffness_field.y: -2, "
                 "stiffness_field.z: 9, stiffness_field.radius: 5}}\n"
                 "  - {effect: stiffness_field, variant: 'free ball, place 2', values: "
                 "{stiffness_field.place2.a: 1.5, stiffness_field.place2.x: -2, "
                 "stiffness_field.place2.y: 2, stiffness_field.place2.z: 27, "
                 "stiffness_field.place2.radius: 5}}\n",
       .loads = test::kPressAndTwist});
  Workspace workspace(small.scene);
  ModelForm form = base_form(small.scene);
  const Effect& field = *find_effect("stiffness_field");
  form.ingredients.push_back(field.rebuild(form.realise(form.initial()), "free ball"));
  VectorXd start = form.initial();
  start.tail(6) << -1.0, 1.0, 0.0, 11.0, 5.0, 1.0;
  Step one;
  one.fitted = fit(workspace, form, start).value();
  one.diagnosis = diagnose(workspace, one.fitted).value();
  const Floor& floor = one.diagnosis.floor;
  ASSERT_FALSE(at_floor(one.fitted, floor));

  const EffectScore& first = one.diagnosis.effects.front();
  EXPECT_EQ(first.effect, "stiffness_field");
  ASSERT_TRUE(first.best);
  EXPECT_THAT(first.best->variant(), testing::EndsWith(", place 2"));
  const Fitted both = add_effect(workspace, one.fitted, first, {}).value();
  EXPECT_TRUE(at_floor(both, floor)) << both.evaluation.chi(false) / floor.chi;
  EXPECT_NEAR(test::value_of(both, "stiffness_field.z"), 9.0, 1.0);
  EXPECT_NEAR(test::value_of(both, "stiffness_field.place2.z"), 27.0, 1.0);
  EXPECT_GT(test::value_of(both, "stiffness_field.place2.a"), 0.5);
}

}  // namespace
}  // namespace hookeye
