// Forms of one effect: names that may stand beside one another, sentences that tell which form it
// is, and plainer forms that say the same.
#include <gmock/gmock.h>

#include <map>
#include <set>

#include "estimation/effects_scene.h"

namespace hookeye::test {

namespace {

/// What may stand in a model more than once has numbers of its own each time: where it was wrong
/// from one example on and again from another, no name stands twice.
TEST(Catalogue, FormsThatMayStandTogetherShareNoName) {
  for (const Effect* effect : catalogue()) {
    if (!effect->several()) continue;
    std::map<std::string, std::string> of;
    for (const auto& one : effect->candidates(base_model(), nullptr))
      for (const Parameter& p : one->parameters()) {
        const auto [found, fresh] = of.emplace(p.name, one->variant());
        EXPECT_TRUE(fresh) << p.name << " of [" << found->second << "] and [" << one->variant()
                           << "]";
      }
  }
}

/// From the start, names are plain.
TEST(Catalogue, NamesTellTheExample) {
  const auto first_name = [](const char* effect, const char* variant) {
    return find_effect(effect)->candidate(base_model(), variant)->parameters().front().name;
  };
  EXPECT_EQ(first_name("camera_pose", "front from the start"), "camera_pose.front.rx");
  EXPECT_EQ(first_name("camera_pose", "front from twist on"), "camera_pose.front from twist on.rx");
  EXPECT_EQ(first_name("light_direction", "sun from the start"), "light_direction.angle1");
  EXPECT_EQ(first_name("light_direction", "sun in twist"), "light_direction.in twist.angle1");
  EXPECT_EQ(first_name("light_direction", "strength from bend on"),
            "light_direction.from bend on.strength");
  EXPECT_EQ(first_name("defocus", "side from the start"), "defocus.side");
  EXPECT_EQ(first_name("defocus", "side from pull on"), "defocus.side from pull on");
}

TEST(Catalogue, SentencesTellWhichAndWhen) {
  const auto said = [](const char* effect, const char* variant, const VectorXd& values) {
    const Effect& one = *find_effect(effect);
    return one.sentence(base_model(), *one.candidate(base_model(), variant), values);
  };
  VectorXd gains = VectorXd::Zero(8);
  gains[2] = 0.10, gains[5] = -0.20, gains[7] = 0.05, gains[0] = -0.01;
  EXPECT_EQ(said("exposure", "each photo", gains),
            "each photo has its own exposure: the photo of 'twist' by 'side' is 18.1 % darker, the "
            "photo of 'pull' by 'front' is 10.5 % brighter, the photo of 'bend' by 'side' is "
            "5.13 % brighter, the others by 1.01 % at most");
  EXPECT_EQ(said("creep", "steadily with the order", VectorXd::Constant(1, 0.25)),
            "the body creeps from 'rest' on, the first example: in the last ('press') it gives 25 "
            "% more, growing steadily with the order");
  EXPECT_EQ(said("camera_pose", "side from bend on", VectorXd::Zero(6)),
            "camera side from bend on stands elsewhere, turned by 0 degrees and moved by 0 mm");
  EXPECT_EQ(said("light_direction", "lamp from bend on", Vector3d(0.03, 0.04, -0.1)),
            "from bend on the light comes from 2.86 degrees beside the told direction and is 9.52 "
            "% weaker");
}

/// What a plainer form does without is nothing at its null.
TEST(Catalogue, PlainerFormsSayTheSameWithoutTheirNumbers) {
  const VectorXd q = deformed_state(*block_scene());
  std::set<std::string> tried;
  for (const Effect* effect : catalogue())
    for (const auto& one : effect->candidates(base_model(), nullptr)) {
      VectorXd values = some_values(*one);
      auto larger = effect->refit_form(base_model(), one, values);
      if (effect->name() == "floor_contact")  // one that without its tilt is normal to an axis
        larger =
            effect->candidate(base_model(), "cushion towards (0, 0, 1), tilting about (1, 2, 41)");
      values = some_values(*larger);
      VectorXd fewer = values;
      const auto found = effect->plainer_form(base_model(), *larger, fewer);
      if (!found) continue;
      std::set<std::string> kept;
      for (const Parameter& p : found->parameters()) kept.insert(p.name);
      const auto all = larger->parameters();
      ASSERT_EQ(fewer.size(), static_cast<int>(kept.size())) << larger->variant();
      ASSERT_LT(kept.size(), all.size()) << larger->variant();
      for (size_t i = 0; i < all.size(); ++i)
        if (!kept.count(all[i].name)) values[i] = all[i].value;
      fewer = values;
      const auto same = effect->plainer_form(base_model(), *larger, fewer);
      if (!same) continue;  // a plane that is oblique without its tilt
      const ModelForm form = extended(base(), larger), other = extended(base(), same);
      const VectorXd expected = signature(form.realise(with_values(form, values)), q);
      const VectorXd plain = signature(other.realise(with_values(other, fewer)), q);
      EXPECT_LT((plain - expected).norm(), 1e-9 * expected.norm()) << larger->variant();
      tried.insert(effect->name());
    }
  EXPECT_EQ(tried, (std::set<std::string>{"floor_contact", "light_direction"}));
}

}  // namespace

}  // namespace hookeye::test
