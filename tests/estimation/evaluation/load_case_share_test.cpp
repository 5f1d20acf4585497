#include "estimation/evaluation/load_case_share.h"

#include <gmock/gmock.h>

#include "estimation/evaluation/load_case_bytes.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

using test::SmallScene;
using testing::ElementsAre;

TEST(LoadCaseShare, DealsTheLongestFirst) {
  EXPECT_THAT(dealt({1.0, 5.0, 2.0, 3.0, 1.0}, 2), ElementsAre(0, 0, 1, 1, 1));
  EXPECT_THAT(dealt({0.0, 0.0, 0.0}, 2), ElementsAre(0, 1, 0)) << "of equals, one after the other";
  EXPECT_THAT(dealt({4.0, 0.0}, 3), ElementsAre(0, 1)) << "somebody has nothing to do";
  EXPECT_THAT(dealt({2.0, 3.0}, 1), ElementsAre(0, 0));
}

TEST(LoadCaseShare, MovesALoadCaseOnlyWhereItPays) {
  EXPECT_THAT(dealt_again({3.0, 1.9, 1.9}, 2, {0, 0, 1}), ElementsAre(0, 1, 1)) << "3.8 for 4.9";
  EXPECT_THAT(dealt_again({3.0, 2.0, 2.6}, 2, {0, 0, 1}), ElementsAre(0, 0, 1)) << "4.6 for 5";
  EXPECT_THAT(dealt_again({1.0, 1.0}, 2, {}), ElementsAre(0, 1));
}

/// All that an evaluation holds: pictures, flow, derivatives, equilibria.
std::vector<LoadCaseShare::Result> results() {
  const SmallScene small({});
  Workspace workspace(small.scene);
  const ModelForm form = base_form(small.scene);
  EvaluationOptions options;
  options.pictures = true;
  auto evaluation = workspace.evaluate(form, form.initial(), options);
  EXPECT_TRUE(evaluation);
  std::vector<LoadCaseShare::Result> out;
  for (auto& one : evaluation->examples) out.push_back({std::move(one), {}, 0.25});
  return out;
}

TEST(LoadCaseBytes, HoldEveryBit) {
  for (const LoadCaseShare::Result& told : results()) {
    const std::string bytes = to_bytes(told);
    const LoadCaseShare::Result read = from_bytes(bytes);
    EXPECT_EQ(to_bytes(read), bytes);
    EXPECT_EQ(read.evaluation.S, told.evaluation.S);
    EXPECT_EQ(read.evaluation.equilibrium->q, told.evaluation.equilibrium->q);
    ASSERT_EQ(read.evaluation.photos.size(), told.evaluation.photos.size());
    for (size_t i = 0; i < read.evaluation.photos.size(); ++i) {
      const PhotoEvaluation &there = read.evaluation.photos[i], &here = told.evaluation.photos[i];
      EXPECT_EQ(there.sums.JtJ, here.sums.JtJ);
      EXPECT_EQ(there.r2, here.r2);
      EXPECT_EQ(there.model.values, here.model.values);
      EXPECT_EQ(there.flow.rms_px(), here.flow.rms_px());
    }
    EXPECT_EQ(read.seconds, 0.25);
    EXPECT_TRUE(read.ended);
  }
}

TEST(LoadCaseBytes, TellAFailure) {
  LoadCaseShare::Result told;
  told.ended = no_result({"pull", 0.5, "an element inverts", NumericalFailure::Kind::no_memory});
  const LoadCaseShare::Result read = from_bytes(to_bytes(told));
  ASSERT_FALSE(read.ended);
  EXPECT_EQ(read.ended.error().example, "pull");
  EXPECT_EQ(read.ended.error().load_fraction, 0.5);
  EXPECT_EQ(read.ended.error().reason, "an element inverts");
  EXPECT_TRUE(out_of_memory(read.ended.error()));
  EXPECT_EQ(read.evaluation.equilibrium, nullptr);
}

TEST(LoadCaseBytes, InPartAreRefused) {
  const std::string bytes = to_bytes(results().front());
  for (size_t parts = 0; parts < 40; ++parts)
    EXPECT_THROW(from_bytes(bytes.substr(0, bytes.size() * parts / 40)), std::runtime_error)
        << parts;
  EXPECT_THROW(from_bytes(bytes + "x"), std::runtime_error);
}

}  // namespace
}  // namespace hookeye
