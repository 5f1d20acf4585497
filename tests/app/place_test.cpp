// hookeye place from outside; what it finds is tested in tests/placing.
#include <gmock/gmock.h>

#include "app/cli.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

/// A cube in two cameras, which look at it from where the capture does not tell it to lie.
class PlaceCli : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_cube("{z: 1}");
    std::string text = read(folder_ / "capture.yaml");
    const auto put = [&](const std::string& before, const std::string& what) {
      text.insert(text.find(before), what);
    };
    put("  mesh:", "  # cast in spring\n");
    put("regions:",
        "cameras:  # by hand\n"
        "  front:\n    size: [400, 300]\n"
        "    intrinsics: {fx: 1000, fy: 1000, cx: 199.5, cy: 149.5}\n"
        "    pose: {rotation: [[1, 0, 0], [0, 0, -1], [0, 1, 0]], translation: [0, 0, 100]}\n"
        "  side:\n    size: [400, 300]\n"
        "    intrinsics: {fx: 1000, fy: 1000, cx: 199.5, cy: 149.5}\n"
        "    pose: {rotation: [[0, 1, 0], [0, 0, -1], [-1, 0, 0]], translation: [0, 0, 100]}\n");
    write("capture.yaml", text);
    // The cube's origin lies at (1, 2, -3) in the cameras' frame, not turned. Its corners:
    write("pairs.txt", R"(# camera u v  x y z
front 209.304 178.912  0 0 0
front 307.343 178.912  10 0 0
front 208.429 87.000  0 10 10
front 297.714 87.000  10 10 10
side  219.702 179.803  0 0 0
side  221.972 183.208  10 0 0
side  320.712 78.793  0 10 10
)");
  }
  std::string refused(const std::string& arguments) const {
    const std::string before = read(folder_ / "capture.yaml");
    const Result got = hookeye("place capture.yaml " + arguments);
    EXPECT_EQ(got.status, 2) << arguments << got.out << got.err;
    EXPECT_EQ(read(folder_ / "capture.yaml"), before) << arguments;
    EXPECT_TRUE(too_long(got.out).empty());
    return got.err;
  }
};

TEST_F(PlaceCli, PairsArePlacedAndWritten) {
  const std::string before = read(folder_ / "capture.yaml");
  const Result dry = hookeye("place capture.yaml --pairs pairs.txt --dry-run");
  ASSERT_EQ(dry.status, 0) << dry.err;
  EXPECT_THAT(dry.out, HasSubstr("placed by 7 of 7 pairs"));
  EXPECT_THAT(dry.out, HasSubstr("not written (--dry-run)"));
  EXPECT_EQ(read(folder_ / "capture.yaml"), before);
  const Result got = hookeye("place capture.yaml --pairs pairs.txt --json");
  ASSERT_EQ(got.status, 0) << got.err;
  const json d = json::parse(got.out);
  EXPECT_EQ(d["by"], "pairs");
  EXPECT_EQ(d["written"], true);
  EXPECT_EQ(d["pairs"].size(), 7u);
  const std::vector<double> shift = d["placement"]["translation"];
  const std::vector<double> true_shift{1, 2, -3};
  for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(shift[i], true_shift[i], 0.01);
  EXPECT_NEAR(d["placement"]["rotation"][0][0].get<double>(), 1.0, 1e-5);
  EXPECT_LT(d["misfit"]["rms"].get<double>(), 0.01);
  std::string after = read(folder_ / "capture.yaml");
  const size_t line = after.find("  placement: {rotation: [[");
  ASSERT_NE(line, std::string::npos);
  after.erase(line, after.find('\n', line) + 1 - line);
  EXPECT_EQ(after, before);
  // A second time it lies where it is told.
  const json again = json::parse(hookeye("place capture.yaml --pairs pairs.txt --json").out);
  EXPECT_LT(again["moved"].get<double>(), 1e-6);
}

TEST_F(PlaceCli, BadInputIsRefusedAndNothingIsWritten) {
  EXPECT_THAT(refused(""), HasSubstr("there is no photo of the body at rest"));
  EXPECT_THAT(refused("--pair front:1,2=3"), HasSubstr("--pair 1: `front:1,2=3` has no three"));
  EXPECT_THAT(refused("--pair front:1,2=1,2,3"), HasSubstr("1 different point of the body"));
  EXPECT_THAT(refused("--pair left:1,2=1,2,3"), HasSubstr("there is no camera `left`"));
  EXPECT_THAT(refused("--pairs none.txt"), HasSubstr("none.txt"));
  EXPECT_THAT(refused("--pairs pairs.txt --scan cube.obj"), HasSubstr("both pairs and a scan"));
  EXPECT_THAT(refused("--scan none.ply"), HasSubstr("none.ply"));
  EXPECT_THAT(refused("--scan cube.obj"), HasSubstr("the scan has 12 triangles"));
  EXPECT_THAT(refused("--scan-unit mm"), HasSubstr("without --scan"));
}

}  // namespace
}  // namespace hookeye::test
