// hookeye place --tags from outside: tags on two faces of a cube, in photos drawn by rays.
#include <gmock/gmock.h>

#include <array>
#include <random>

#include "app/cli.h"
#include "capture_io/capture.h"
#include "capture_io/image.h"
#include "core/helper.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

/// Cells of OpenCV's 4X4_50, row by row: true is white.
constexpr std::array<std::array<bool, 16>, 2> kTags = {
    {{1, 0, 1, 1, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0},
     {0, 0, 0, 0, 1, 1, 1, 1, 1, 0, 0, 1, 1, 0, 1, 0}}};

/// A tag of 6 mm in the middle of a face of 10 mm, white around; x to the right, y down from the
/// face's upper left corner.
double shade(int tag, double x, double y) {
  const double column = x - 2.0, row = y - 2.0;  // cells of 1 mm, rim included
  if (column < 0.0 || row < 0.0 || column >= 6.0 || row >= 6.0) return 0.8;
  const int c = static_cast<int>(column) - 1, r = static_cast<int>(row) - 1;
  if (c < 0 || r < 0 || c > 3 || r > 3) return 0.05;
  return kTags[static_cast<size_t>(tag)][static_cast<size_t>(4 * r + c)] ? 0.8 : 0.05;
}

class PlaceTags : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    if (!fs::exists(helper_folder() / "boards"))
      GTEST_SKIP() << "NOT RUN: OpenCV's aruco is not there";
    write_cube("{z: 1}");
    std::string text = read(folder_ / "capture.yaml");
    text.insert(
        text.find("regions:"),
        "cameras:\n"
        "  front:\n    size: [400, 300]\n"
        "    intrinsics: {fx: 1000, fy: 1000, cx: 199.5, cy: 149.5}\n"
        "    pose: {rotation: [[1, 0, 0], [0, 0, -1], [0, 1, 0]], translation: [0, 0, 100]}\n"
        "  side:\n    size: [400, 300]\n"
        "    intrinsics: {fx: 1000, fy: 1000, cx: 199.5, cy: 149.5}\n"
        "    pose: {rotation: [[0, 1, 0], [0, 0, -1], [-1, 0, 0]], translation: [0, 0, 100]}\n"
        "photos: {encoding: linear, background: black}\n");
    text +=
        "  rest:\n    supports: [{region: base, fix: [x, y, z]}]\n"
        "    photos: {front: front.png, side: side.png}\n";
    write("capture.yaml", text);
    write("tags.txt",
          "# id size  centre  right  down\n"
          "0 6   5 0 5   1 0 0   0 0 -1\n"
          "1 6;  10 5 5; 0 2 0;  0 0 -1\n");
    for (const Camera& camera : read_capture_text().cameras) photograph(camera);
  }

  /// The photos are not there yet.
  Capture read_capture_text() {
    for (const char* name : {"front.png", "side.png"})
      write_image(folder_ / name, Image{400, 300, 1, std::vector<float>(400 * 300, 0.0F)});
    return read_capture(folder_ / "capture.yaml");
  }

  /// The cube's origin lies at (1, 2, -3) in the cameras' frame, not turned. Front sees its face
  /// y = 0, side its face x = 10.
  void photograph(const Camera& camera) const {
    const bool front = camera.name == "front";
    const Eigen::Vector3d origin(1, 2, -3);
    Image image{camera.width, camera.height, 1, {}};
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0.0, 0.004);
    std::uniform_real_distribution<double> within(0.0, 1.0);  // else an edge is seen in quarters
    constexpr int kRays = 4;                                  // a side
    for (int v = 0; v < camera.height; ++v)
      for (int u = 0; u < camera.width; ++u) {
        double sum = 0.0;
        for (int k = 0; k < kRays * kRays; ++k) {
          const Eigen::Vector2d at(u + (k % kRays + within(random)) / kRays - 0.5,
                                   v + (k / kRays + within(random)) / kRays - 0.5);
          const Ray ray = camera.ray(at);
          const Eigen::Vector3d from = ray.origin - origin;
          const int along = front ? 1 : 0;
          const double t = ((front ? 0.0 : 10.0) - from[along]) / ray.direction[along];
          const Eigen::Vector3d X = from + t * ray.direction;
          const double x = front ? X[0] : X[1], y = 10.0 - X[2];
          if (x >= 0.0 && x <= 10.0 && y >= 0.0 && y <= 10.0) sum += shade(front ? 0 : 1, x, y);
        }
        const double value = sum / (kRays * kRays) + noise(random);
        image.values.push_back(static_cast<float>(std::clamp(value, 0.0, 1.0)));
      }
    write_image(folder_ / (camera.name + ".png"), image);
  }

  std::string refused(const std::string& arguments) const {
    const std::string before = read(folder_ / "capture.yaml");
    const Result got = hookeye("place capture.yaml " + arguments);
    EXPECT_EQ(got.status, 2) << arguments << got.out << got.err;
    EXPECT_EQ(read(folder_ / "capture.yaml"), before) << arguments;
    return got.err;
  }
};

TEST_F(PlaceTags, TheBodyLiesWhereItsTagsAre) {
  const Result got = hookeye("place capture.yaml --tags tags.txt --json");
  ASSERT_EQ(got.status, 0) << got.err;
  const json d = json::parse(got.out);
  EXPECT_EQ(d["pairs"].size(), 8u);
  EXPECT_THAT(d["pairs"][0]["at"].get<std::string>(),
              HasSubstr("upper left corner of tag 0 in photo `front` of example `rest`"));
  EXPECT_LT(d["misfit"]["rms"].get<double>(), 0.4);
  const std::vector<double> shift = d["placement"]["translation"];
  const std::vector<double> true_shift{1, 2, -3};
  for (size_t i = 0; i < 3; ++i) {
    const double error = d["standard_errors"]["shift"][i];
    EXPECT_LT(error, 0.2);
    EXPECT_NEAR(shift[i], true_shift[i], 3.0 * error);
  }
  EXPECT_LT(d["turned_degrees"].get<double>(), 1.0);
}

TEST_F(PlaceTags, WhatIsNotSeenIsNamed) {
  write("more.txt", read(folder_ / "tags.txt") + "9 6  5 10 5  -1 0 0  0 0 -1\n");
  const Result got = hookeye("place capture.yaml --tags more.txt --dry-run");
  EXPECT_EQ(got.status, 0) << got.err;
  EXPECT_THAT(got.err, HasSubstr("tag 9 is seen in no photo at rest"));
}

TEST_F(PlaceTags, BadInputIsRefused) {
  EXPECT_THAT(refused("--tags none.txt"), HasSubstr("none.txt"));
  EXPECT_THAT(refused("--tags tags.txt --scan cube.obj"), HasSubstr("both tags and a scan"));
  EXPECT_THAT(refused("--tags tags.txt --dictionary 4x4"), HasSubstr("one of 4X4_50"));
  EXPECT_THAT(refused("--tags tags.txt --dictionary 6X6_50"), HasSubstr("--dictionary 4X4_50"));
  write("other.txt", "7 6  5 0 5  1 0 0  0 0 -1\n");
  EXPECT_THAT(refused("--tags other.txt"), HasSubstr("seen are 0, 1"));
  // Twice as large as it is told: two cameras see that.
  write("large.txt", "0 12  5 0 5  1 0 0  0 0 -1\n1 12  10 5 5  0 1 0  0 0 -1\n");
  EXPECT_THAT(refused("--tags large.txt"), HasSubstr("the pairs do not agree"));
}

}  // namespace
}  // namespace hookeye::test
