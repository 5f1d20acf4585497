// A capture with faults is read as far as it goes, and all its faults are told.
#include "capture_io/partial_capture.h"

#include <gmock/gmock.h>

#include "capture_io/capture_folder.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

PartialCapture read(const CaptureFixture& fixture) {
  fixture.write();
  return read_partly(fixture.folder() / "capture.yaml", fixture.yaml);
}

TEST(PartialCapture, OfARightCaptureIsAllOfIt) {
  const CaptureFixture fixture;
  const PartialCapture partly = read(fixture);
  const Capture whole = read_capture(fixture.folder());
  EXPECT_TRUE(partly.faults.empty()) << partly.faults.front().what();
  EXPECT_EQ(partly.capture.file, whole.file);
  EXPECT_EQ(partly.capture.cameras.size(), whole.cameras.size());
  EXPECT_EQ(partly.capture.cameras[0].t, whole.cameras[0].t);
  EXPECT_EQ(partly.capture.regions.size(), whole.regions.size());
  ASSERT_EQ(partly.capture.examples.size(), whole.examples.size());
  for (size_t i = 0; i < whole.examples.size(); ++i) {
    EXPECT_EQ(partly.capture.examples[i].supports.size(), whole.examples[i].supports.size());
    EXPECT_EQ(partly.capture.examples[i].photos.size(), whole.examples[i].photos.size());
    EXPECT_EQ(partly.capture.examples[i].measured.size(), whole.examples[i].measured.size());
  }
}

TEST(PartialCapture, TellsEveryFaultAndKeepsTheRest) {
  CaptureFixture fixture;
  fixture.replace("front: photos/pull.png", "front: photos/lost.png");
  fixture.replace("law: neo-hookean", "lau: neo-hookean");
  fixture.replace("grip: {faces: grip.txt}", "grip: {faces: none.txt}");
  fixture.yaml += "  torn: {loads: [{region: nowhere, force: [0, 0, 1]}]}\n";
  const PartialCapture partly = read(fixture);
  ASSERT_EQ(partly.faults.size(), 4U);
  EXPECT_THAT(partly.faults[0].wrong(), HasSubstr("lau"));
  EXPECT_THAT(partly.faults[1].what(), HasSubstr("none.txt"));
  EXPECT_THAT(partly.faults[2].what(), HasSubstr("photos/lost.png"));
  EXPECT_THAT(partly.faults[3].wrong(), HasSubstr("nowhere"));
  for (const InputError& fault : partly.faults) EXPECT_GT(fault.place().line, 1);
  ASSERT_EQ(partly.capture.examples.size(), 4U);
  const ExampleSpec& pull = partly.capture.examples[1];
  EXPECT_EQ(pull.supports.size(), 4U);  // the one on the broken region too
  EXPECT_EQ(pull.loads.size(), 2U);
  EXPECT_EQ(pull.photos.size(), 2U);
  EXPECT_EQ(pull.measured.size(), 3U);
  EXPECT_EQ(partly.capture.region("grip")->shape.index(), 4U);
}

TEST(PartialCapture, OfTextThatIsNoneHasOneFault) {
  const CaptureFixture fixture;
  const auto file = fixture.folder() / "capture.yaml";
  EXPECT_EQ(read_partly(file, "a: [1\n").faults.size(), 1U);
  EXPECT_EQ(read_partly(file, "").faults.size(), 1U);
  // Without anything but the number: the four sections that are needed.
  EXPECT_EQ(read_partly(file, "hookeye: 1\n").faults.size(), 4U);
}

}  // namespace
}  // namespace hookeye::test
