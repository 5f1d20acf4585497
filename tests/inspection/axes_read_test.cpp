// Vectors told in other axes: by formulas, and measured forces of a whole capture.
#include "estimation/inspection/axes_read.h"

#include <gmock/gmock.h>

#include <numbers>

#include "inspection/inspected_capture.h"

namespace hookeye::test {
namespace {

using inspection::AxesRead;
using inspection::read_otherwise;
using inspection::ToldVectors;
using testing::HasSubstr;
using testing::Not;

/// What four load cases give, 1.8 times what is expected and off by some percent.
ToldVectors right() {
  ToldVectors out;
  Matrix3Xd expected(3, 4);
  expected.col(0) = Eigen::Vector3d(-0.1, 0.0, 5.4);
  expected.col(1) = Eigen::Vector3d(2.0, 0.1, 3.0);
  expected.col(2) = Eigen::Vector3d(-0.5, 1.5, 4.0);
  expected.col(3) = Eigen::Vector3d(1.0, -2.0, -3.0);
  Matrix3Xd error(3, 4);
  error << 0.05, -0.1, 0.08, 0.02, -0.04, 0.1, 0.06, -0.1, 0.2, -0.15, 0.1, 0.05;
  out.told = 1.8 * expected + error;
  out.expected = {1.05 * expected, expected};
  out.scaled.assign(4, 1), out.sure.assign(4, 1);
  out.sure_told = {true, true, true};
  return out;
}

std::string found(const ToldVectors& vectors, std::vector<int> columns = {}) {
  const auto one = read_otherwise(vectors, std::move(columns), {});
  return one ? one->in_words() + (one->whole ? " (whole)" : "") : "";
}

TEST(AxesRead, RightVectorsAreLeftInPeace) {
  EXPECT_EQ(found(right()), "");
  for (int c = 0; c < 4; ++c) EXPECT_EQ(found(right(), {c}), "") << c;
}

TEST(AxesRead, EverySignIsFound) {
  const char* words[] = {"x has the other sign", "y has the other sign", "z has the other sign"};
  for (int k = 0; k < 3; ++k) {
    ToldVectors vectors = right();
    vectors.told.row(k) *= -1.0;
    EXPECT_EQ(found(vectors), words[k]);
  }
  ToldVectors vectors = right();
  vectors.told.row(0) *= -1.0, vectors.told.row(2) *= -1.0;
  EXPECT_EQ(found(vectors), "x and z have the other sign");
  vectors.told.row(1) *= -1.0;
  EXPECT_EQ(found(vectors), "x and y and z have the other sign (whole)");
}

TEST(AxesRead, EveryOrderOfTheAxesIsFound) {
  const auto order = [](int x, int y, int z) {
    ToldVectors vectors = right();
    const Matrix3Xd told = vectors.told;
    vectors.told.row(0) = told.row(x), vectors.told.row(1) = told.row(y);
    vectors.told.row(2) = told.row(z);
    return found(vectors);
  };
  EXPECT_EQ(order(1, 0, 2), "x and y stand in one another's places");
  EXPECT_EQ(order(0, 2, 1), "y and z stand in one another's places");
  EXPECT_EQ(order(1, 2, 0), "x is the told z, y is the told x, z is the told y");
  ToldVectors turned = right();  // by a quarter about z
  const Matrix3Xd told = turned.told;
  turned.told.row(0) = -told.row(1), turned.told.row(1) = told.row(0);
  EXPECT_EQ(found(turned), "x is the told y, y is the told -x");
}

TEST(AxesRead, OneLoadCaseAlone) {
  ToldVectors vectors = right();
  std::swap(vectors.told(0, 1), vectors.told(1, 1));
  EXPECT_EQ(found(vectors, {1}), "x and y stand in one another's places");
  for (const int c : {0, 2, 3}) EXPECT_EQ(found(vectors, {c}), "") << c;
  vectors = right();
  vectors.told(2, 3) *= -1.0;
  EXPECT_EQ(found(vectors, {3}), "z has the other sign");
}

/// What is next to nothing, as told or as expected, has no sign.
TEST(AxesRead, SmallOnesSayNothing) {
  ToldVectors vectors = right();
  vectors.told(0, 0) *= -1.0;
  EXPECT_EQ(found(vectors, {0}), "");
  vectors = right();
  vectors.told.row(0) *= -1.0;
  vectors.sure_told[0] = false;
  EXPECT_EQ(found(vectors), "");
}

/// A load that points 25 degrees elsewhere, about any axis, is no axis of the other sign.
TEST(AxesRead, ATurnedLoadIsNotAnotherAxis) {
  for (int k = 0; k < 3; ++k)
    for (const double degrees : {-25.0, 25.0}) {
      ToldVectors vectors = right();
      vectors.told =
          Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Eigen::Vector3d::Unit(k)) *
          vectors.told;
      EXPECT_EQ(found(vectors), "") << k << " " << degrees;
    }
}

constexpr const char* kPulledAskew = R"(hookeye_recipe: 1
title: three motions of a grip
seed: 5
body:
  shape: block
  size: [22, 16, 34]
  taper: 0.9
  mesh: {edge: 6}
  density: 1.07e-9
  texture: {texel: 0.1, speckle: 1.3}
material:
  law: neo-hookean
  true: {mu: 0.05, kappa_over_mu: 10}
  told: {mu: 0.03}
  fit: [mu]
cameras: {count: 2, size: [200, 240], distance: 6, focal: 950, spread: 55}
examples:
  rest: {}
  along: {move: [0, 0, 0.1]}
  askew: {move: [0.15, 0, 0.05]}
  aside: {move: [0.02, 0.12, 0.03]}
truth: {edge_factor: 0.8, rays_per_axis: 4}
)";

/// Every `force_on: grip` of the examples, as `f` makes it.
void change_forces(InspectedCapture& capture, const std::vector<std::string>& examples,
                   const std::function<Eigen::Vector3d(Eigen::Vector3d)>& f) {
  for (const ExampleSpec& example : read_capture(capture.folder()).examples) {
    if (std::find(examples.begin(), examples.end(), example.name) == examples.end()) continue;
    for (const MeasuredSpec& measured : example.measured) {
      if (measured.kind != MeasuredSpec::Kind::force_on) continue;
      const Eigen::Vector3d now = f(measured.value);
      capture.change("(\n  " + example.name + ":\n[^#]*?force_on: grip, value: )\\[[^\\]]*\\]",
                     fmt::format("$1[{:.9f}, {:.9f}, {:.9f}]", now[0], now[1], now[2]));
    }
  }
}

const std::vector<std::string> kAll = {"along", "askew", "aside"};

TEST(MeasuredForces, RightOnesAreLeftInPeace) {
  EXPECT_EQ(said(InspectedCapture(kPulledAskew).inspect()), "");
}

TEST(MeasuredForces, OneAxisOfTheOtherSign) {
  InspectedCapture capture(kPulledAskew);
  change_forces(capture, kAll,
                [](Eigen::Vector3d f) { return Eigen::Vector3d(-f[0], f[1], f[2]); });
  const Inspection seen = capture.inspect();
  ASSERT_EQ(seen.warnings.size(), 1U) << said(seen);
  EXPECT_THAT(said(seen), HasSubstr("`force_on: grip` of all 3 examples"));
  EXPECT_THAT(said(seen), HasSubstr("x has the other sign"));
}

TEST(MeasuredForces, TwoAxesExchanged) {
  InspectedCapture capture(kPulledAskew);
  change_forces(capture, kAll, [](Eigen::Vector3d f) { return Eigen::Vector3d(f[1], f[0], f[2]); });
  EXPECT_THAT(said(capture.inspect()), HasSubstr("x and y stand in one another's places"));
}

TEST(MeasuredForces, AnAxisOfOneLoadCase) {
  InspectedCapture capture(kPulledAskew);
  change_forces(capture, {"askew"},
                [](Eigen::Vector3d f) { return Eigen::Vector3d(f[0], f[1], -f[2]); });
  const std::string seen = said(capture.inspect());
  EXPECT_THAT(seen, HasSubstr("`force_on: grip` of example `askew`"));
  EXPECT_THAT(seen, HasSubstr("z has the other sign"));
  EXPECT_THAT(seen, Not(HasSubstr("`along`")));
}

TEST(MeasuredForces, OneValueInKilonewtons) {
  InspectedCapture capture(kPulledAskew);
  change_forces(capture, {"along"}, [](const Eigen::Vector3d& f) { return f / 1000.0; });
  const std::string seen = said(capture.inspect());
  EXPECT_THAT(seen, HasSubstr("`force_on: grip` of example `along`"));
  EXPECT_THAT(seen, HasSubstr("in another unit"));
  EXPECT_THAT(seen, Not(HasSubstr("one another's places")));
}

/// A force that is expected within its noise is no unit: a zero may have drifted by more.
TEST(MeasuredForces, AZeroThatDriftedIsNoUnit) {
  InspectedCapture capture(kPulledAskew);
  change_forces(capture, {"along"}, [](const Eigen::Vector3d& f) { return 60.0 * f; });
  EXPECT_THAT(said(capture.inspect()), HasSubstr("in another unit"));
  capture.change("sigma: [0-9.e-]+", "sigma: 1000");
  EXPECT_THAT(said(capture.inspect()), Not(HasSubstr("in another unit")));
}

}  // namespace
}  // namespace hookeye::test
