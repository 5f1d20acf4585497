// Slips of the pen whose message guesses where they come from.
#include <gmock/gmock.h>

#include "capture_io/broken_case.h"

namespace hookeye::test {
namespace {

TEST(Slips, DecimalCommas) {
  CaptureFixture capture;
  swap("force: [0, 0, 2.5]}", "force: [0,1, 0,2, 2,5]}")(capture);
  capture.write();
  EXPECT_THAT(capture.complaint(),
              testing::HasSubstr("three numbers are expected, with decimal points: [0.5, 0.25, "
                                 "2.4]"));
}

TEST(Slips, AnEmptyPhoto) {
  CaptureFixture capture;
  capture.write_file("photos/pull.png", "");
  capture.write();
  EXPECT_THAT(capture.complaint(), testing::HasSubstr("the file is empty: it has no bytes"));
}

}  // namespace
}  // namespace hookeye::test
