// hookeye place from outside; what it finds is tested in tests/placing.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "app/cli.h"
#include "capture_io/image.h"

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

/// A box of the cameras' frame, from `from` to `to`, as a camera of SetUp() sees it: white on
/// black. `rows`: the camera's rotation.
Image silhouette_of_box(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                        const Eigen::Matrix3d& rows) {
  Image out{400, 300, 1, std::vector<float>(400 * 300, 0.0f)};
  const Eigen::Vector3d centre = -rows.transpose() * Eigen::Vector3d(0, 0, 100);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const Eigen::Vector3d way =
          rows.transpose() * Eigen::Vector3d((x - 199.5) / 1000, (y - 149.5) / 1000, 1);
      double enter = 0.0, leave = INFINITY;
      for (int i = 0; i < 3; ++i) {
        const double a = (from[i] - centre[i]) / way[i], b = (to[i] - centre[i]) / way[i];
        enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
      }
      if (enter < leave) out.at(x, y) = 1.0f;
    }
  return out;
}

/// Writes the silhouettes, and tells them as a photo at rest.
void put_photos(const fs::path& folder, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  Eigen::Matrix3d front, side;
  front << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  side << 0, 1, 0, 0, 0, -1, -1, 0, 0;
  write_image(folder / "front.png", silhouette_of_box(from, to, front));
  write_image(folder / "side.png", silhouette_of_box(from, to, side));
  std::ofstream(folder / "capture.yaml", std::ios::app)
      << "  rest:\n    photos:\n      front: front.png\n      side: side.png\n"
         "photos: {kind: silhouette}\n";
}

TEST_F(PlaceCli, AnOutlineThatGoesWithThePhotosIsWritten) {
  put_photos(folder_, {1, 2, -3}, {11, 12, 7});
  const Result got = hookeye("place capture.yaml");
  ASSERT_EQ(got.status, 0) << got.err;
  EXPECT_THAT(got.out, HasSubstr("written to"));
  EXPECT_THAT(got.err, testing::Not(HasSubstr("contradict")));
}

/// The photos show a longer body than the mesh: no place of the cube goes with them.
TEST_F(PlaceCli, APlaceThatThePhotosContradictIsNotWritten) {
  put_photos(folder_, {1, 2, -3}, {14, 12, 7});
  const std::string said = refused("");
  EXPECT_THAT(said, HasSubstr("the photos contradict the place of the body"));
  EXPECT_THAT(said, HasSubstr("camera `front`"));
  EXPECT_THAT(said, HasSubstr("--pair"));
  // Written by hand all the same, `check` says so.
  std::string text = read(folder_ / "capture.yaml");
  const std::string key = "placement: {";
  const size_t at = said.find(key), end = said.find('}', at);
  ASSERT_NE(at, std::string::npos);
  text.insert(text.find("  mesh:"), "  " + said.substr(at, end + 1 - at) + "\n");
  write("capture.yaml", text);
  const Result checked = hookeye("check capture.yaml --quick");
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_THAT(checked.err, HasSubstr("the photos contradict the place of the body"));
}

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
