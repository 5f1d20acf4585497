#include "estimation/fit/decision.h"

#include <gmock/gmock.h>

#include <cmath>

namespace hookeye {
namespace {

TEST(Decision, KnowsTheLineThatToldIt) {
  Decision heard;
  const Decided keep = [&](const Decision& one) { heard = one; };
  const int line = __LINE__ + 1;
  EXPECT_TRUE(tell(keep, {Asked::stands, "gravity", true, {1.0, 2.0, "floor.at"}, "why"}));
  EXPECT_THAT(heard.where, testing::EndsWith("decision_test.cpp:" + std::to_string(line)));
  EXPECT_FALSE(tell({}, {Asked::named, "creep", false, {}, ""}));
}

TEST(Decision, ComesBackAsItWasWritten) {
  for (int k = 0; k <= static_cast<int>(Asked::scored); ++k) {
    Decision one{static_cast<Asked>(k), "creep as 'x'", k % 2 == 0, {}, "because"};
    one.where = "a.cpp:3";
    if (k % 3 == 0) one.parts = {{"fitted", -1.5}, {"sure", 0.25}};
    const Decision back = decision_from_json(nlohmann::json::parse(to_json(one).dump()));
    EXPECT_EQ(back.asked, one.asked);
    EXPECT_EQ(back.accepted, one.accepted);
    EXPECT_TRUE(std::isnan(back.by.value) && std::isnan(back.by.limit));
    EXPECT_EQ(to_json(back), to_json(one));
  }
  EXPECT_ANY_THROW(decision_from_json({{"asked", "nothing"}}));
}

}  // namespace
}  // namespace hookeye
