// Forms of one effect: names that may stand beside one another, sentences that tell which form it
// is, and plainer forms that say the same.
#include <gmock/gmock.h>

#include <map>
#include <set>

#include "estimation/effects_scene.h"

namespace hookeye::test {

namespace {

const ModelForm& base() {
  static const ModelForm form = base_form(block_scene());
  return form;
}

const Model& base_model() {
  static const Model model = with_states(base().realise(base().initial()));
  return model;
}

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

/// What a plainer form does without is nothing at its null.
TEST(Catalogue, PlainerFormsSayTheSameWithoutTheirNumbers) {
  const VectorXd q = deformed_state(*block_scene());
  std::set<std::string> tried;
  for (const Effect* effect : catalogue())
    for (const auto& one : effect->candidates(base_model(), nullptr)) {
      VectorXd values = some_values(*one);
      const auto larger = effect->refit_form(base_model(), one, values);
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
