// hookeye plan from outside: its sentence goes with the table that `diagnose` prints.
#include <gmock/gmock.h>

#include "app/fitted_run.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

/// Effects that would look alike stand in a column beside one that leads: both are explained.
TEST_F(FittedRun, ThePlanExplainsAColumnOfConfusionsBesideALeader) {
  const Result diagnosed = hookeye("diagnose run");
  ASSERT_EQ(diagnosed.status, 0) << diagnosed.err;
  EXPECT_THAT(diagnosed.out, HasSubstr("confused with: changes these photos nearly alike, whether "
                                       "it is there or not"));
  const json diagnosis = timeline().at("steps").back().at("diagnosis");
  const bool alike = std::any_of(diagnosis.begin(), diagnosis.end(), [](const json& one) {
    return !one.value("confused_with", json::array()).empty();
  });
  ASSERT_TRUE(alike) << "the photos tell all effects apart: another recipe";
  const Result planned = hookeye("plan run --json");
  ASSERT_EQ(planned.status, 0) << planned.err;
  const json plan = json::parse(planned.out);
  const std::string sentence = plan.at("sentence");
  EXPECT_THAT(sentence, HasSubstr("what `confused with` lists would look alike if it were there: "
                                  "`--between A,B` plans for two of those"));
}

}  // namespace
}  // namespace hookeye::test
