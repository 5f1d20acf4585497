// Effects in forms that the first refit does not have: fibres that stiffen are reached from those
// that the score asks for, the others by the forms that a standing effect goes on to.
#include "estimation/search/widening.h"

#include <gmock/gmock.h>

#include <stdexcept>

#include "estimation/effects/catalogue.h"
#include "estimation/fit/at_floor.h"
#include "estimation/search/swaps.h"
#include "tests/search/hiding.h"

namespace hookeye {
namespace {

using test::hiding;
using test::kPressAndTwist;
using testing::ElementsAre;

/// The base model with a field of stiffness and these effects, each in its variant.
ModelForm with_field_and(const test::SmallScene& small,
                         const std::vector<std::pair<std::string, std::string>>& effects) {
  ModelForm form = base_form(small.scene);
  const Model model = form.realise(form.initial());
  form.ingredients.push_back(find_effect("stiffness_field")->candidates(model, nullptr).front());
  EXPECT_THAT(form.ingredients.back()->variant(), testing::StartsWith("field"));
  for (const auto& [effect, variant] : effects) {
    form.ingredients.push_back(find_effect(effect)->candidate(model, variant));
    if (!form.ingredients.back()) throw std::runtime_error("no " + effect + " as " + variant);
  }
  return form;
}

/// Fitted alone a field takes on what the clamp does, and no one place says as much. Once the clamp
/// stands beside it, one does.
TEST(Widening, AFieldBesideALaterEffectIsAskedForOnePlace) {
  const test::SmallScene small(
      {.hidden = "hidden:\n  - {effect: stiffness_field, variant: free blob, values: "
                 "{stiffness_field.a: -1.5, stiffness_field.x: 3, stiffness_field.y: -2, "
                 "stiffness_field.z: 18, stiffness_field.radius: 5}}\n"
                 "  - {effect: soft_clamp, variant: base, values: {soft_clamp.base.normal: 60, "
                 "soft_clamp.base.tangent: 60}}\n",
       .loads = kPressAndTwist});
  Workspace workspace(small.scene);
  const size_t at = base_form(small.scene).ingredients.size();
  const ModelForm form = with_field_and(small, {{"soft_clamp", "base"}});
  const Fitted field = fit(workspace, form, form.initial()).value();
  const Floor floor = measure_floor(*small.scene, field.evaluation);
  ASSERT_FALSE(on_floor(field, floor));
  const Fitted place = widened(workspace, field, at, floor, {}).value();
  EXPECT_EQ(place.form.ingredients[at]->variant(), "free blob");
  EXPECT_TRUE(at_floor(place, floor));
  EXPECT_NEAR(place.p[4], 18.0, 0.2);
}

/// Most of what is over the floor is a misaligned load's, which an edge cannot take.
TEST(Widening, APlaceGetsItsEdgeBesideWhatElseIsMissing) {
  const test::SmallScene small(
      {.hidden = "hidden:\n  - {effect: stiffness_field, variant: free ball, values: "
                 "{stiffness_field.a: -2, stiffness_field.x: 3, stiffness_field.y: -2, "
                 "stiffness_field.z: 18, stiffness_field.radius: 8, "
                 "stiffness_field.thickness: 0.5}}\n"
                 "  - {effect: load_direction, variant: in pull, values: "
                 "{load_direction.pull.angle1: 0.004, load_direction.pull.angle2: -0.004}}\n",
       .loads = kPressAndTwist});
  Workspace workspace(small.scene);
  ModelForm form = base_form(small.scene);
  const size_t at = form.ingredients.size();
  const Model model = form.realise(form.initial());
  form.ingredients.push_back(find_effect("stiffness_field")->rebuild(model, "free blob"));
  VectorXd p = form.initial();
  p.tail(5) << -1.5, 2.5, -1.5, 18.0, 6.0;  // from farther off it may end on the way
  const Fitted faded = fit(workspace, form, p).value();
  const Floor floor = measure_floor(*small.scene, faded.evaluation);
  const Fitted edged = widened(workspace, faded, at, floor, {}).value();
  EXPECT_EQ(edged.form.ingredients[at]->variant(), "free ball");
  EXPECT_NEAR(edged.p[5], 8.0, 0.5);
  EXPECT_GT(over_floor(edged, floor, false), 0.5 * over_floor(faded, floor, false));
}

/// A body swells and touches a hard wall. Fitted as a cushion beside a field of stiffness, the wall
/// is hard again where the field leaves.
TEST(Widening, AFieldLeavesTogetherWithTheWallsCushion) {
  const test::SmallScene small(
      {.hidden = "hidden:\n  - {effect: swelling, variant: uniform, values: {swelling.s: 0.03}}\n"
                 "  - {effect: floor_contact, variant: hard plane on side +x, values: "
                 "{floor_contact.position: 10.6}}\n",
       .loads = kPressAndTwist});
  Workspace workspace(small.scene);
  const size_t first = base_form(small.scene).ingredients.size();
  const ModelForm form =
      with_field_and(small, {{"floor_contact", "cushion on side +x"}, {"swelling", "uniform"}});
  VectorXd start = form.initial();
  const Eigen::Index wall = form.layout()[first + 1].first;
  start[wall] = 10.4, start[wall + 1] = 1e-3, start[wall + 2] = 0.02;
  const Fitted with = fit(workspace, form, start).value();
  const Floor floor = measure_floor(*small.scene, with.evaluation);
  ASSERT_TRUE(at_floor(with, floor));
  const auto lighter = drop_beside_smaller(workspace, with, floor, first, {});
  ASSERT_TRUE(lighter);
  EXPECT_EQ(lighter->effect, "stiffness_field");
  EXPECT_THAT(effects_in(lighter->fitted.form), ElementsAre("floor_contact", "swelling"));
  EXPECT_THAT(lighter->fitted.form.ingredients[first]->variant(), testing::StartsWith("hard"));
  EXPECT_NEAR(lighter->fitted.p[form.layout()[first].first], 10.6, 0.01);
  EXPECT_FALSE(drop_beside_smaller(workspace, lighter->fitted, floor, first, {}));
}

/// Fitted in the form `variant` from `start`, which is not the floor, an effect goes on to another.
class WiderForm : public testing::Test {
 protected:
  std::optional<Fitted> ask(const std::string& hidden, const std::string& effect,
                            const std::string& variant, const VectorXd& start,
                            const char* more = kPressAndTwist) {
    small_.emplace(hiding(hidden, more));
    Workspace workspace(small_->scene);
    ModelForm form = base_form(small_->scene);
    const size_t at = form.ingredients.size();
    form.ingredients.push_back(
        find_effect(effect)->candidate(form.realise(form.initial()), variant));
    if (!form.ingredients.back()) return std::nullopt;
    VectorXd p = form.initial();
    p.tail(start.size()) = start;
    const FitOptions options;
    const DiscoverEvents events;
    const Fitted narrow = fit(workspace, form, p, options).value();
    const Floor floor = measure_floor(*small_->scene, narrow.evaluation);
    EXPECT_FALSE(at_floor(narrow, floor));
    auto wide = WiderForms(workspace, options, events).ask(narrow, at, floor).value();
    EXPECT_TRUE(!wide || at_floor(*wide, floor));
    return wide;
  }

 private:
  std::optional<test::SmallScene> small_;
};

/// Told across, the load points up more than across. From below, the refit keeps the part along the
/// body with the wrong sign.
TEST_F(WiderForm, ALoadIsAskedForItsMirrorImage) {
  const auto asked =
      ask("{effect: load_direction, variant: in side, values: {load_direction.side.angle1: 1.2, "
          "load_direction.side.angle2: 0.3}}",
          "load_direction", "in side", Eigen::Vector2d(-1.2, 0.3));
  ASSERT_TRUE(asked);
  EXPECT_NEAR(asked->p[1], 1.2, 0.01);
  EXPECT_NEAR(asked->p[2], 0.3, 0.01);
}

TEST_F(WiderForm, APlaceIsAskedForAnEdge) {
  VectorXd start(5);
  start << -1.0, 2.0, -1.0, 18.0, 4.0;
  const auto asked =
      ask("{effect: stiffness_field, variant: free ball, values: {stiffness_field.a: -2, "
          "stiffness_field.x: 3, stiffness_field.y: -2, stiffness_field.z: 18, "
          "stiffness_field.radius: 8, stiffness_field.thickness: 0.5}}",
          "stiffness_field", "free blob", start);
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked->form.ingredients.back()->variant(), "free ball");
  EXPECT_NEAR(asked->p[4], 18.0, 0.1);
  EXPECT_NEAR(asked->p[5], 8.0, 0.2);
}

TEST_F(WiderForm, AHardPlaneIsAskedForACushion) {
  const auto asked = ask(
      "{effect: floor_contact, variant: cushion on side +x, values: {floor_contact.position: 10.5, "
      "floor_contact.k: 0.001}}",
      "floor_contact", "hard plane on side +x", VectorXd::Constant(1, 11.0));
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked->form.ingredients.back()->variant(), "cushion on side +x");
  EXPECT_NEAR(asked->p[1], 10.5, 0.1);
  EXPECT_NEAR(asked->p[2], 0.001, 1e-4);
}

/// The bent block meets a hard wall with an edge, in one of its corners or the other: straight from
/// next to the body the fit ends where the one gives way to the other, at a turn of -0.109.
TEST_F(WiderForm, AHardTiltingPlaneIsNotLeftOnAKink) {
  const auto asked =
      ask("{effect: floor_contact, variant: \"hard plane towards (1, 0, 0), tilting about (0, 0, "
          "30), stiffness 1.4\", values: {floor_contact.position: 14.5521, floor_contact.tilt1: "
          "-0.1563, floor_contact.tilt2: -0.0735}}",
          "floor_contact", "hard plane on side +x", VectorXd::Constant(1, 11.0),
          "  lean: {force: [0.0283, 0.0025, 0]}\n  twist: {rotate: 20}\n");
  ASSERT_TRUE(asked);
  EXPECT_THAT(asked->form.ingredients.back()->variant(),
              testing::StartsWith("hard plane towards (1, 0, 0)"));
  EXPECT_NEAR(asked->p[2], -0.1563, 0.01);
  EXPECT_NEAR(asked->p[3], -0.0735, 0.01);
}

}  // namespace
}  // namespace hookeye
