// Photos and measured values that stand in one another's places, and measured values with the other
// sign.
#include "estimation/inspection/exchanges.h"

#include <gmock/gmock.h>

#include "inspection/inspected_capture.h"

namespace hookeye::test {
namespace {

using inspection::ComparedWays;
using inspection::Exchange;
using inspection::MotionSums;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

MotionSums sums(const Eigen::VectorXd& seen, const Eigen::VectorXd& expected) {
  MotionSums out;
  out.seen2 = seen.squaredNorm(), out.expected2 = expected.squaredNorm();
  out.both = seen.dot(expected), out.count = 1.0;
  return out;
}

/// What stands in each place, against what is expected there.
ComparedWays compared(const std::vector<Eigen::Vector2d>& seen,
                      const std::vector<Eigen::Vector2d>& expected, bool scaled) {
  ComparedWays out;
  out.ways.resize(1);
  out.scaled.assign(seen.size(), scaled);
  for (const auto& one : seen) {
    out.ways[0].emplace_back();
    for (const auto& other : expected) out.ways[0].back().push_back(sums(one, other));
  }
  return out;
}

std::vector<Exchange> found(const std::vector<Eigen::Vector2d>& seen,
                            const std::vector<Eigen::Vector2d>& expected, bool scaled = true) {
  return inspection::exchanges({compared(seen, expected, scaled)}, {});
}

/// Two loads along one line differ in size alone, and the stiffness is not known.
TEST(Exchanges, ParallelLoadsAreToldByTheirSizes) {
  const std::vector<Eigen::Vector2d> loads = {{1, 0}, {2, 0}, {0, 3}};
  EXPECT_THAT(found({{5, 0.1}, {9, 0}, {0, 16}}, loads), IsEmpty());
  const auto one = found({{9, 0}, {5, 0.1}, {0, 16}}, loads);
  ASSERT_EQ(one.size(), 1U);
  EXPECT_THAT(one[0].places, ElementsAre(0, 1));
  EXPECT_THAT(one[0].fits, ElementsAre(1, 0));
  EXPECT_GT(one[0].told, 0.2);
  EXPECT_LT(one[0].exchanged, 0.02);
}

/// Files sorted as 1, 10, 2: each shows the next one's load.
TEST(Exchanges, ALongerMixUpIsOne) {
  const auto one = found({{0, 3}, {1, 0}, {-2, 2}}, {{1, 0}, {-2, 2}, {0, 3}});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_THAT(one[0].places, ElementsAre(0, 1, 2));
  EXPECT_THAT(one[0].fits, ElementsAre(2, 0, 1));
}

/// A weight that the capture leaves out is in all of them; sizes that are nearly the same, noise
/// and a shape that is off by a third say nothing.
TEST(Exchanges, WhatAllShareSpeaksForNone) {
  const std::vector<Eigen::Vector2d> loads = {{1, 0}, {1.2, 0}, {-1, 0.5}};
  EXPECT_THAT(found({{1, -9}, {1.2, -9}, {-1, -8.5}}, loads), IsEmpty());
  EXPECT_THAT(found({{1.2, 0}, {1, 0}, {-1, 0.5}}, loads), IsEmpty());
  EXPECT_THAT(found({{1, 0.3}, {1.3, -0.4}, {-1, 0.9}}, loads), IsEmpty());
}

/// How far a prescribed motion goes is known.
TEST(Exchanges, PrescribedMotionsHaveNoFactor) {
  EXPECT_THAT(found({{2, 0}, {4, 0}}, {{1, 0}, {2, 0}}, false), IsEmpty());
  EXPECT_EQ(found({{2, 0}, {1, 0}}, {{1, 0}, {2, 0}}, false).size(), 1U);
}

constexpr const char* kSeries = R"(hookeye_recipe: 1
title: two pulls, a press and a stretch
seed: 5
body:
  shape: block
  size: [22, 16, 34]
  taper: 0.9
  bumps: 0.06
  facet: 5
  mesh: {edge: 6}
  density: 1.07e-9
  texture: {texel: 0.1, speckle: 1.3}
material:
  law: neo-hookean
  true: {mu: 0.05, kappa_over_mu: 10}
  told: {mu: 0.03}
  fit: [mu]
cameras: {count: 2, size: [400, 480], distance: 6, focal: 1900, spread: 55}
examples:
  rest: {}
  pull: {force: [0, 0, 0.15]}
  pull_more: {force: [0, 0, 0.3]}
  press: {move: [0, 0, -0.07]}
  stretch: {move: [0, 0, 0.1]}
truth: {edge_factor: 0.8, rays_per_axis: 4}
)";

void swap_photos(InspectedCapture& capture, const std::string& camera) {
  capture.change("photos/pull_" + camera, "photos/other");
  capture.change("photos/pull_more_" + camera, "photos/pull_" + camera);
  capture.change("photos/other", "photos/pull_more_" + camera);
}

/// A regular expression of the three numbers of `force_on: grip` in an example.
std::string force_in(const std::string& example) {
  return "(\n  " + example + ":\n[^#]*?force_on: grip, value: )\\[([^\\]]*)\\]";
}

std::vector<double> force_of(const InspectedCapture& capture, const std::string& example) {
  for (const ExampleSpec& one : read_capture(capture.folder()).examples)
    if (one.name == example)
      for (const MeasuredSpec& measured : one.measured)
        if (measured.kind == MeasuredSpec::Kind::force_on)
          return {measured.value.begin(), measured.value.end()};
  return {};
}

std::string list(const std::vector<double>& numbers, double times) {
  return "$1[" + std::to_string(times * numbers[0]) + ", " + std::to_string(times * numbers[1]) +
         ", " + std::to_string(times * numbers[2]) + "]";
}

TEST(ExchangedPhotos, ARightSeriesIsLeftInPeace) {
  EXPECT_EQ(said(InspectedCapture(kSeries).inspect()), "");
}

TEST(ExchangedPhotos, TwoPullsInEachOthersPlacesAreNamedWithTheirFiles) {
  InspectedCapture capture(kSeries);
  swap_photos(capture, "cam0");
  swap_photos(capture, "cam1");
  const std::string seen = said(capture.inspect());
  EXPECT_THAT(seen, HasSubstr("exchanges: "));
  EXPECT_THAT(seen, HasSubstr("photo `cam0` of example `pull` shows the motion of example "
                              "`pull_more`"));
  EXPECT_THAT(seen, HasSubstr("photos of camera `cam1`: `pull_more`: photos/pull_more_cam1.png, "
                              "`pull`: photos/pull_cam1.png"));
  EXPECT_THAT(seen, Not(HasSubstr("press")));
}

TEST(ExchangedPhotos, OneCameraAloneIsSeen) {
  InspectedCapture capture(kSeries);
  swap_photos(capture, "cam1");
  const std::string seen = said(capture.inspect());
  EXPECT_THAT(seen, HasSubstr("photos of camera `cam1`"));
  EXPECT_THAT(seen, Not(HasSubstr("photos of camera `cam0`")));
}

TEST(MeasuredValues, TheSignOfOneForceIsSeen) {
  InspectedCapture capture(kSeries);
  capture.change(force_in("press"), list(force_of(capture, "press"), -1.0));
  const std::string seen = said(capture.inspect());
  EXPECT_THAT(seen, HasSubstr("measured_values: "));
  EXPECT_THAT(seen, HasSubstr("`force_on: grip` of example `press`"));
  EXPECT_THAT(seen, HasSubstr("the other sign"));
  EXPECT_THAT(seen, HasSubstr("the body move as the capture tells"));
  EXPECT_THAT(seen, Not(HasSubstr("`force_on: grip` of example `stretch`")));
}

TEST(MeasuredValues, TheSignOfAllIsOneWarning) {
  InspectedCapture capture(kSeries);
  for (const char* example : {"press", "stretch"})
    capture.change(force_in(example), list(force_of(capture, example), -1.0));
  const Inspection seen = capture.inspect();
  ASSERT_EQ(seen.warnings.size(), 1U) << said(seen);
  EXPECT_THAT(said(seen), HasSubstr("as in all 2 examples"));
  EXPECT_THAT(said(seen), HasSubstr("what the support exerts on the body"));
}

TEST(MeasuredValues, ValuesOfAnotherLoadCaseAreSeen) {
  InspectedCapture capture(kSeries);
  const auto press = force_of(capture, "press"), stretch = force_of(capture, "stretch");
  capture.change(force_in("press"), list(stretch, 1.0));
  capture.change(force_in("stretch"), list(press, 1.0));
  const std::string seen = said(capture.inspect());
  EXPECT_THAT(seen, HasSubstr("fits example `stretch`"));
  EXPECT_THAT(seen, HasSubstr("the values of these examples stand in one another's places"));
  EXPECT_THAT(seen, Not(HasSubstr("the other sign")));
}

}  // namespace
}  // namespace hookeye::test
