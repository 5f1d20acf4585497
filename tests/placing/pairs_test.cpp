// Points picked in photos give the body's place, within the errors that are told; wrong ones are
// named.
#include "placing/pairs.h"

#include <gmock/gmock.h>

#include <fstream>

#include "placing/placed_capture.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const std::vector<Vector3d> kPoints = {{0, 0, 0},   {40, 0, 0},    {40, 10, 28}, {0, 28, 16},
                                       {0, 0, 16},  {40, 0, 28},   {12, 28, 0},  {0, 28, 0},
                                       {40, 10, 0}, {12, 10, 19.6}};

class Pairs : public testing::Test {
 protected:
  /// `count` pairs, one camera after the other, picked `sigma` px off.
  std::vector<PickedPair> picked(const PlacedCapture& placed, size_t count, size_t cameras,
                                 double sigma) {
    std::normal_distribution<double> noise(0.0, sigma);
    std::vector<PickedPair> out;
    for (size_t i = 0; i < count; ++i) {
      Eigen::Vector2d pixel = placed.truly_seen(i % cameras, kPoints[i]);
      if (sigma > 0) pixel += Eigen::Vector2d(noise(random_), noise(random_));
      out.push_back({placed.capture().cameras[i % cameras].name,
                     pixel,
                     kPoints[i],
                     {"pairs.txt", static_cast<int>(i + 1)}});
    }
    return out;
  }
  std::string refused(const std::vector<PickedPair>& pairs, const PlacedCapture& placed,
                      double sigma = 1.0) {
    try {
      place_by_pairs(pairs, placed.capture(), placed.body(), {sigma});
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }
  std::mt19937 random_{5};
};

TEST_F(Pairs, ExactOnesGiveThePlaceFromAnywhere) {
  for (const double degrees : {10.0, 90.0, 175.0}) {
    const PlacedCapture placed({}, random_motion(middle_of(Shape::bracket), degrees, 60, random_));
    for (const size_t cameras : {1, 2}) {
      const auto pairs = picked(placed, 8, cameras, 0.0);
      const PairFit found = place_by_pairs(pairs, placed.capture(), placed.body(), {});
      EXPECT_LT(placed.off(found.placing.motion), 1e-5) << degrees << " " << cameras;
      EXPECT_LT(found.placing.misfit, 1e-6);
      EXPECT_THAT(found.placing.warnings, IsEmpty());
      EXPECT_THAT(found.placing.others, IsEmpty());
    }
  }
}

TEST_F(Pairs, ErrorsAreThoseOfRepeatedPicking) {
  const PlacedCapture placed({}, random_motion(middle_of(Shape::bracket), 20, 10, random_));
  const Isometry3d truth =
      place_by_pairs(picked(placed, 10, 2, 0.0), placed.capture(), placed.body(), {})
          .placing.motion;
  constexpr int kRepeats = 100;
  double sum = 0.0;
  for (int i = 0; i < kRepeats; ++i) {
    const PairFit found = place_by_pairs(picked(placed, 10, 2, 1.0), placed.capture(),
                                         placed.body(), {.sigma_px = 1.0});
    const Eigen::AngleAxisd turn(
        Eigen::Matrix3d(found.placing.motion.linear() * truth.linear().transpose()));
    Vector6d off;
    off << turn.angle() * turn.axis(),
        found.placing.motion * placed.body().middle - truth * placed.body().middle;
    sum += off.dot(found.placing.covariance.ldlt().solve(off));
  }
  // chi2 of six numbers: mean 6, here +- 0.35; errors that grow with a bad rms make it smaller.
  EXPECT_GT(sum / kRepeats, 4.0);
  EXPECT_LT(sum / kRepeats, 7.1);
}

TEST_F(Pairs, WrongOnesAreLeftOutAndNamed) {
  const PlacedCapture placed({}, random_motion(middle_of(Shape::bracket), 25, 10, random_));
  auto pairs = picked(placed, 10, 2, 0.5);
  std::swap(pairs[2].pixel, pairs[8].pixel);  // two corners of one camera confused
  const PairFit found = place_by_pairs(pairs, placed.capture(), placed.body(), {});
  EXPECT_LT(placed.off(found.placing.motion), 0.6);
  for (size_t i = 0; i < pairs.size(); ++i) EXPECT_EQ(found.used[i] != 0, i != 2 && i != 8) << i;
  ASSERT_EQ(found.placing.warnings.size(), 2u);
  EXPECT_THAT(found.placing.warnings[0], HasSubstr("pairs.txt:3: left out, off by"));
  EXPECT_THAT(found.placing.warnings[1], HasSubstr("pairs.txt:9: left out, off by"));
}

TEST_F(Pairs, OneOfFiveIsFound) {
  const PlacedCapture placed({}, random_motion(middle_of(Shape::bracket), 25, 10, random_));
  auto pairs = picked(placed, 5, 2, 0.3);
  pairs[3].pixel += Eigen::Vector2d(25, -10);
  const PairFit found = place_by_pairs(pairs, placed.capture(), placed.body(), {});
  EXPECT_LT(placed.off(found.placing.motion), 1.0);
  EXPECT_EQ(found.used, (std::vector<char>{1, 1, 1, 0, 1}));
}

TEST_F(Pairs, ThreeInOneCameraLeaveSeveralPlaces) {
  const PlacedCapture placed({}, random_motion(middle_of(Shape::bracket), 8, 3, random_));
  const PairFit found =
      place_by_pairs(picked(placed, 3, 1, 0.0), placed.capture(), placed.body(), {});
  EXPECT_FALSE(found.placing.others.empty());
  EXPECT_LT(placed.off(found.placing.motion), 0.1);  // the one nearer to the told place
  EXPECT_THAT(found.placing.warnings, testing::Contains(HasSubstr("ambiguous")));
}

TEST_F(Pairs, FourThatDoNotAgreeAreRefusedWithTheDoubtfulOne) {
  const PlacedCapture placed({}, random_motion(middle_of(Shape::bracket), 8, 3, random_));
  auto pairs = picked(placed, 4, 2, 0.2);
  std::swap(pairs[0].pixel, pairs[2].pixel);
  EXPECT_THAT(refused(pairs, placed), HasSubstr("the pairs do not agree"));
  EXPECT_THAT(refused(pairs, placed), HasSubstr("--sigma"));
  EXPECT_THAT(refused(pairs, placed, 50.0), IsEmpty());
}

TEST_F(Pairs, WhatCannotTellAPlaceIsRefused) {
  const PlacedCapture placed({}, Isometry3d::Identity());
  auto pairs = picked(placed, 6, 2, 0.0);
  auto two = std::vector<PickedPair>(pairs.begin(), pairs.begin() + 2);
  two.push_back(two.front());
  EXPECT_THAT(refused(two, placed), HasSubstr("2 different points"));
  auto line = pairs;
  for (size_t i = 0; i < line.size(); ++i) line[i].point = Vector3d(7.0 * double(i), 0, 0);
  EXPECT_THAT(refused(line, placed), HasSubstr("lie on one line"));
  auto outside = pairs;
  outside[1].pixel.x() = 320.0;
  EXPECT_THAT(refused(outside, placed), HasSubstr("pairs.txt:2: pixel (320, "));
  auto unknown = pairs;
  unknown[2].camera = "cam";
  EXPECT_THAT(refused(unknown, placed), HasSubstr("pairs.txt:3: there is no camera `cam`"));
}

TEST_F(Pairs, PointsOffTheBodyAreTold) {
  const PlacedCapture placed({}, Isometry3d::Identity());
  auto pairs = picked(placed, 6, 2, 0.0);
  for (PickedPair& pair : pairs) pair.point *= 1.5;
  const std::string all = [&] {
    std::string text;
    for (const auto& w :
         place_by_pairs(pairs, placed.capture(), placed.body(), {.sigma_px = 50}).placing.warnings)
      text += w + "\n";
    return text;
  }();
  EXPECT_THAT(all, HasSubstr("off the body's surface"));
}

TEST(ReadPairs, TakesAPairApart) {
  const PickedPair pair = read_pair("front:412.5,-0.25=1e1, 0,+80", {"--pair 1"});
  EXPECT_EQ(pair.camera, "front");
  EXPECT_EQ(pair.pixel, Eigen::Vector2d(412.5, -0.25));
  EXPECT_EQ(pair.point, Vector3d(10, 0, 80));
  for (const char* wrong : {"front", "front:1,2", "front:1=1,2,3", "front:1,2=1,2", ":1,2=3,4,5",
                            "front:1,2=1,2,x", "front:1,2=1,2,3,", "front:1,nan=1,2,3"})
    EXPECT_THROW(read_pair(wrong, {"--pair 1"}), InputError) << wrong;
}

TEST(ReadPairs, FilesHaveCommentsAndAnySeparator) {
  const TemporaryFolder folder;
  std::ofstream(folder / "pairs.txt") << "# camera u v x y z\r\n"
                                         "front 412.5 233  10 0 80  # a corner\r\n\r\n"
                                         "left,1,2,3,4,5\r\n"
                                         "left;1;2;3;4;5.5\n";
  const auto pairs = read_pairs(folder / "pairs.txt");
  ASSERT_EQ(pairs.size(), 3u);
  EXPECT_EQ(pairs[0].point, Vector3d(10, 0, 80));
  EXPECT_EQ(pairs[1].camera, "left");
  EXPECT_EQ(pairs[2].point.z(), 5.5);
  EXPECT_EQ(pairs[2].place.line, 5);
  std::ofstream(folder / "bad.txt") << "front 412.5 233  10 0 80\nfront 1 2 3 4\n";
  try {
    read_pairs(folder / "bad.txt");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().line, 2);
  }
  std::ofstream(folder / "none.txt") << "# nothing\n";
  EXPECT_THROW(read_pairs(folder / "none.txt"), InputError);
}

}  // namespace
}  // namespace hookeye::test
