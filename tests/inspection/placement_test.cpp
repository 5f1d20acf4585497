// Whether the outlines of photos at rest are where the told place of the body has them.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "inspection/inspected_capture.h"

namespace hookeye::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// The right capture, of one colour, with the body shifted by `mm` along x of the world.
Inspection shifted(double mm, const std::string& more = "",
                   const std::string& texture = "texture: {uniform: 0.5}") {
  InspectedCapture capture;
  capture.change("texture: \\{image[^}]*\\}", texture);
  capture.change("\nbody:", fmt::format("\nbody:\n  placement: {{rotation: [[1, 0, 0], [0, 1, 0], "
                                        "[0, 0, 1]], translation: [{}, 0, 0]{}}}",
                                        mm, more));
  return capture.inspect({.first_guess = false});
}

TEST(PlacementToldTo, LieElsewhereThanPhotosShowIsContradicted) {
  EXPECT_THAT(said(shifted(4)), AllOf(HasSubstr("the photos contradict the place of the body"),
                                      HasSubstr("camera `cam0`"), HasSubstr("--pair")));
  // A fit starts there, too.
  EXPECT_THAT(said(shifted(4, ", fit: true")), HasSubstr("the photos contradict the place"));
}

TEST(PlacementToldTo, LieWhereTheyShowItIsNot) {
  EXPECT_EQ(said(shifted(0)), "");
  EXPECT_EQ(said(shifted(0.2)), "");  // half a per cent of the body
}

}  // namespace
}  // namespace hookeye::test
