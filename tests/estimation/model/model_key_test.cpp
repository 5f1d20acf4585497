#include "estimation/model/model_key.h"

#include <gmock/gmock.h>

#include "estimation/effects/catalogue.h"
#include "estimation/effects_scene.h"

namespace hookeye::test {

namespace {

ModelForm with(const std::vector<std::pair<std::string, std::string>>& effects) {
  ModelForm form = base();
  for (const auto& [name, variant] : effects) {
    form.ingredients.push_back(find_effect(name)->candidate(base_model(), variant));
    EXPECT_TRUE(form.ingredients.back()) << name << " " << variant;
  }
  return form;
}

TEST(ModelKey, IsTheSameInWhateverOrderEffectsCame) {
  const auto ball = std::pair{"stiffness_field", "free ball"};
  const auto bend = std::pair{"load_direction", "in bend"};
  EXPECT_EQ(ModelKey(with({ball, bend})), ModelKey(with({bend, ball})));
  EXPECT_NE(ModelKey(with({ball})), ModelKey(with({ball, bend})));
  EXPECT_NE(ModelKey(with({bend})), ModelKey(with({{"load_direction", "in pull"}})));
}

TEST(FormKey, TellsAFormInWords) {
  const ModelForm form = with({{"stiffness_field", "free ball"}});
  EXPECT_EQ(key_of(*form.ingredients.back()).words(), "stiffness_field as 'free ball'");
  EXPECT_EQ((FormKey{"gravity", ""}.words()), "gravity");
}

}  // namespace

}  // namespace hookeye::test
