// hookeye effects: the catalogue on a terminal and as JSON.
#include <gmock/gmock.h>

#include "app/cli.h"
#include "estimation/effects/catalogue.h"
#include "estimation/model/effect.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(Cli, EffectsListsTheCatalogue) {
  const Result list = hookeye("effects");
  EXPECT_EQ(list.status, 0);
  EXPECT_EQ(list.err, "");
  EXPECT_THAT(too_long(list.out), IsEmpty());
  for (const Effect* effect : catalogue()) EXPECT_THAT(list.out, HasSubstr("  " + effect->name()));
}

/// In the block of the catalogue every effect has a form, and every form its parameters.
TEST_F(Cli, EffectsAsJsonHaveFormsParametersAndSentences) {
  const Result all = hookeye("effects --json");
  ASSERT_EQ(all.status, 0);
  const json document = json::parse(all.out);
  ASSERT_EQ(document.at("effects").size(), catalogue().size());
  for (size_t i = 0; i < catalogue().size(); ++i) {
    const json& effect = document.at("effects")[i];
    EXPECT_EQ(effect.at("name"), catalogue()[i]->name());
    EXPECT_EQ(effect.at("manual"), catalogue()[i]->manual());
    ASSERT_FALSE(effect.at("forms").empty()) << effect.at("name");
    for (const json& form : effect.at("forms")) {
      EXPECT_NE(form.at("sentence"), "");
      ASSERT_FALSE(form.at("parameters").empty()) << effect.at("name") << form.at("form");
      for (const json& p : form.at("parameters")) {
        EXPECT_TRUE(p.at("low").is_null() || p.at("low") <= p.at("null")) << p;
        EXPECT_TRUE(p.at("high").is_null() || p.at("high") >= p.at("null")) << p;
        EXPECT_GT(p.at("matters"), 0.0) << p;
      }
    }
  }
}

TEST_F(Cli, EffectsOfOneNameTellWhatARefitMayGoOnTo) {
  for (const Effect* effect : catalogue()) {
    const Result one = hookeye("effects " + effect->name());
    EXPECT_EQ(one.status, 0);
    EXPECT_THAT(too_long(one.out), IsEmpty()) << effect->name();
    EXPECT_THAT(one.out, HasSubstr("said as: ")) << effect->name();
  }
  const std::string field = hookeye("effects stiffness_field").out;
  for (const char* told : {"free blob", "stiffness_field.radius", "a1 .. a16"})
    EXPECT_THAT(field, HasSubstr(told));
  EXPECT_THAT(field, testing::Not(testing::ContainsRegex("e-1[5-9]")))
      << "rounding stands as a null";
  const Result wrong = hookeye("effects gravty");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("did you mean 'gravity'"));
}

/// Of a capture: its units, and why an effect cannot be present in it.
TEST_F(Cli, EffectsOfACaptureSayWhatCannotBeTestedThere) {
  write_cube("{z: 1}");
  const Result own = hookeye("effects --capture .");
  EXPECT_EQ(own.status, 0) << own.err;
  EXPECT_THAT(own.out, HasSubstr("not possible here: no photo is fitted"));
  EXPECT_THAT(hookeye("effects camera_pose --capture .").out, HasSubstr("not possible here"));
  EXPECT_EQ(hookeye("effects --capture nowhere").status, 2);
}

}  // namespace
}  // namespace hookeye::test
