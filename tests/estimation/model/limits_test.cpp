// Options: each has a reason, a range and a name of its own; what is set is checked.
#include "estimation/model/limits.h"

#include <gmock/gmock.h>

#include <set>

#include "core/input_error.h"

namespace hookeye {
namespace {

TEST(Limits, EachHasANameAReasonASourceAndARange) {
  std::set<std::string> names;
  for (const LimitSpec& spec : specs({})) {
    EXPECT_TRUE(names.insert(spec.name).second) << spec.name;
    EXPECT_FALSE(spec.what.empty() || spec.source.empty()) << spec.name;
    EXPECT_LE(spec.low, spec.standard) << spec.name;
    EXPECT_GE(spec.high, spec.standard) << spec.name;
    EXPECT_EQ(spec.value, spec.standard) << spec.name;
  }
  EXPECT_GT(names.size(), 50u);
}

TEST(Limits, AreSetByNameWithinTheirRange) {
  Limits limits;
  set_limit(limits, "floor.at", 1.5, "here");
  set_limit(limits, "search.leaders", 5.0, "here");
  EXPECT_EQ(limits.floor.at, 1.5);
  EXPECT_EQ(limits.search.leaders, 5);
  EXPECT_EQ(changed(limits),
            (std::map<std::string, double>{{"floor.at", 1.5}, {"search.leaders", 5.0}}));
  for (const auto& [name, value] :
       {std::pair("floor.at", 0.9), {"search.leaders", 2.5}, {"no.such", 1.0}})
    try {
      set_limit(limits, name, value, "here");
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      EXPECT_EQ(error.place().file, "here");
    }
  EXPECT_EQ(limits.floor.at, 1.5);
}

}  // namespace
}  // namespace hookeye
