// Blocks that CalculiX solved, read from its decks as a user would: capture, mesh, supports,
// weight.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "real/cases.h"
#include "support/shared_data.h"
#include "support/temporary_folder.h"

namespace hookeye {
namespace {

class Deck : public testing::TestWithParam<const char*> {};

TEST_P(Deck, IsSolvedAsCalculiXSolvedIt) {
  HOOKEYE_NEEDS_DATA("reference");
  const test::TemporaryFolder folder;
  const auto block =
      real::solve_reference(test::shared_data() / "reference", folder.path(), GetParam());
  fmt::print("{}: {:.1e} mm of {:.1f} mm\n", GetParam(), block.distance_mm, block.largest_mm);
  EXPECT_LE(block.distance_mm, 2e-5);
  EXPECT_GT(block.largest_mm, 39.0);
}

INSTANTIATE_TEST_SUITE_P(Of, Deck,
                         testing::Values("b10k_A", "b10k_B", "q10k_A", "q10k_B", "q30k_A",
                                         "q30k_B"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace hookeye
