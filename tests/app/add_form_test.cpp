// The form of an added effect: chosen by its name, told, and refused with those that there are.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "app/fitted_run.h"
#include "estimation/model/declaration.h"

namespace hookeye::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(FormName, IsWhatAFormIsWhereverItStands) {
  for (const auto& [variant, name] : std::vector<std::pair<std::string, std::string>>{
           {"", ""},
           {"free ball", "ball"},
           {"blob around (-0.01, -1.28, 18.29), radius 5.7", "blob"},
           {"field of bumps, radius 6.96, around (1, 2, 3) (4, 5, 6)", "field of bumps"},
           {"halves across (1.000, 0.000, 0.000)", "halves"},
           {"free layers across (0.162, 0.718, 0.677)", "layers"},
           {"along (1.000, 0.000, 0.000)", "along"},
           {"plane at +x side, position 10.2375", "plane at +x side"},
           {"cam0 from pull on", "cam0 from pull on"},
           {"free pulling, volume counted, around (1, 0, 0)", "pulling, volume counted"}})
    EXPECT_EQ(form_name(variant), name) << variant;
}

TEST_F(FittedRun, AnEffectIsAddedInTheFormThatIsNamed) {
  const Result refused = hookeye("add run swelling --as cube");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(on_one_line(refused.err),
              AllOf(HasSubstr("swelling has no such form"), HasSubstr("'uniform'"),
                    HasSubstr("'blob'"), HasSubstr("'gradient'")));
  EXPECT_EQ(timeline().at("steps").size(), 1U);
  EXPECT_EQ(hookeye("add run gravity --as cube").status, 2);

  const Result added = hookeye("add run swelling --as gradient");
  ASSERT_EQ(added.status, 0) << added.err;
  EXPECT_THAT(on_one_line(added.out),
              AllOf(HasSubstr("form: free gradient"), HasSubstr("`--as FORM` takes another"),
                    HasSubstr("'uniform'"), Not(HasSubstr("'gradient'"))));
  EXPECT_THAT(read(folder_ / "run/steps/01-swelling/model.yaml"), HasSubstr("gradient"));

  const Result uniform = hookeye("add run swelling --take-back");
  ASSERT_EQ(uniform.status, 0) << uniform.err;
  const Result again = hookeye("add run swelling --as uniform");
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("form:      uniform"));

  // The sentence has the interval of what it says: that of the table, in percent.
  const json step = timeline().at("steps").back();
  const std::string says = step.at("says").at(0);
  const json& parameters = step.at("parameters");
  const auto stretch = std::find_if(parameters.begin(), parameters.end(),
                                    [](const json& one) { return one.at("name") == "swelling.s"; });
  ASSERT_NE(stretch, parameters.end());
  for (const char* end : {"low", "high"})
    EXPECT_THAT(says,
                HasSubstr(fmt::format("{:.3g}", 100.0 * std::abs(stretch->at(end).get<double>()))));
  EXPECT_THAT(says, HasSubstr("95 %"));
  EXPECT_THAT(on_one_line(again.out), HasSubstr(says));
}

TEST_F(Cli, EffectsNamesTheForms) {
  EXPECT_THAT(
      on_one_line(hookeye("effects stiffness_field").out),
      HasSubstr("`hookeye add RUN stiffness_field --as FORM` takes one of: 'field of "
                "bumps', 'blob', 'halves', 'blobs', 'gradient', 'layers', 'balls', 'ball'"));
}

}  // namespace
}  // namespace hookeye::test
