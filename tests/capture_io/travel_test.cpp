// Travels of supports that are known within a sigma.
#include "capture_io/travel.h"

#include <gtest/gtest.h>

#include "capture_io/broken_case.h"

namespace hookeye::test {
namespace {

Capture read(CaptureFixture& capture) {
  capture.write();
  return read_capture(capture.folder());
}

const ExampleSpec& pull(const Capture& capture) {
  for (const ExampleSpec& example : capture.examples)
    if (example.name == "pull") return example;
  throw std::logic_error("no example pull");
}

TEST(Travel, ASigmaBesideAMoveIsAMeasurementOfIt) {
  CaptureFixture capture;
  const size_t before = pull(read(capture)).measured.size();
  swap("move: {x: 0, y: 0.5}", "move: {x: 0, y: 0.5}, sigma: 0.02")(capture);
  const Capture told = read(capture);
  ASSERT_EQ(pull(told).measured.size(), before + 1);
  const MeasuredSpec& of_it = pull(told).measured.front();
  EXPECT_EQ(of_it.kind, MeasuredSpec::Kind::travel_of);
  EXPECT_EQ(of_it.direction, Vector3d::UnitY());
  EXPECT_EQ(of_it.value[0], 0.5);
  EXPECT_EQ(of_it.sigma[0], 0.02);
  EXPECT_EQ(prescribed_travel(pull(told).supports.at(1)), Vector3d(0, 0.5, 0));
}

struct Wrong {
  const char *from, *to, *message;
};

TEST(Travel, ASigmaWithoutATravelIsRefused) {
  for (const Wrong& wrong : {
           Wrong{"move: {x: 0, y: 0.5}", "move: {x: 0, y: 0}, sigma: 0.02", "has none"},
           Wrong{"move: {x: 0, y: 0.5}", "move: {x: 0, y: 0.5}, sigma: 0", "above zero"},
           Wrong{"move: {x: 0, y: 0.5}", "move: {x: 0, y: 0.5}, sigma: [1, 2]", "sigma"},
       }) {
    CaptureFixture capture;
    swap(wrong.from, wrong.to)(capture);
    capture.write();
    EXPECT_NE(capture.complaint().find(wrong.message), std::string::npos) << capture.complaint();
    EXPECT_NE(capture.complaint().find("capture.yaml:48:"), std::string::npos)
        << capture.complaint();
  }
}

}  // namespace
}  // namespace hookeye::test
