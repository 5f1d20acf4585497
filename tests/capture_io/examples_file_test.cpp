// `examples: {from: FILE}`: the map of load cases in a file of its own.
#include <gtest/gtest.h>

#include "capture_io/capture.h"
#include "capture_io/capture_folder.h"
#include "capture_io/fingerprints.h"
#include "capture_io/partial_capture.h"
#include "capture_io/yaml_place.h"

namespace hookeye::test {
namespace {

/// Moves the examples into examples.yaml.
void part_examples(CaptureFixture& capture) {
  const size_t begin = capture.yaml.find("examples:\n");
  capture.write_file("examples.yaml", capture.yaml.substr(begin));
  capture.yaml.replace(begin, std::string::npos, "examples: {from: examples.yaml}\n");
}

TEST(ExamplesFileTest, TheExamplesAreThoseOfTheFile) {
  CaptureFixture capture;
  capture.write();
  const Capture in_place = read_capture(capture.folder());
  part_examples(capture);
  capture.write();
  const Capture parted = read_capture(capture.folder());
  ASSERT_EQ(parted.examples.size(), in_place.examples.size());
  for (size_t i = 0; i < parted.examples.size(); ++i) {
    EXPECT_EQ(parted.examples[i].name, in_place.examples[i].name);
    EXPECT_EQ(parted.examples[i].validate, in_place.examples[i].validate);
    EXPECT_EQ(parted.examples[i].supports.size(), in_place.examples[i].supports.size());
    EXPECT_EQ(parted.examples[i].loads.size(), in_place.examples[i].loads.size());
    ASSERT_EQ(parted.examples[i].photos.size(), in_place.examples[i].photos.size());
    for (size_t p = 0; p < parted.examples[i].photos.size(); ++p)
      EXPECT_EQ(parted.examples[i].photos[p].file, in_place.examples[i].photos[p].file);
  }
}

TEST(ExamplesFileTest, AnExampleMayBeCalledFrom) {
  CaptureFixture capture;
  capture.replace("  held_out:\n", "  from:\n");
  capture.write();
  EXPECT_EQ(read_capture(capture.folder()).examples[2].name, "from");
}

TEST(ExamplesFileTest, PlacesAreThoseOfTheFile) {
  CaptureFixture capture;
  part_examples(capture);
  capture.write();
  const YamlPlaces places(capture.folder() / "capture.yaml", "here/capture.yaml");
  EXPECT_EQ(places.of({"examples", "pull", "use"}).str(), "here/examples.yaml:5:5");
}

/// A run is made from the file, and from the photos that it names.
TEST(ExamplesFileTest, ItAndWhatItNamesAreInputs) {
  CaptureFixture capture;
  part_examples(capture);
  capture.write();
  const auto then = fingerprints(capture.folder() / "capture.yaml");
  EXPECT_TRUE(then.contains("examples.yaml"));
  EXPECT_TRUE(then.contains("photos/pull.png"));
  capture.write_grey("photos/pull.png", 8, 6, 0.25f);
  EXPECT_EQ(changed_since(then, fingerprints(capture.folder() / "capture.yaml")),
            "photos/pull.png");
}

/// All faults at once, as `hookeye edit` asks for them.
TEST(ExamplesFileTest, EveryFaultOfTheFileIsTold) {
  CaptureFixture capture;
  capture.replace("region: grip, force: [0, 0, 2.5]", "region: grib, force: [0, 0, 2.5]");
  capture.replace("fix: [z]", "fix: [w]");
  part_examples(capture);
  capture.write();
  const PartialCapture read = read_partly(capture.folder() / "capture.yaml", capture.yaml);
  EXPECT_EQ(read.capture.examples.size(), 3u);
  ASSERT_EQ(read.faults.size(), 2u);
  for (const InputError& fault : read.faults)
    EXPECT_TRUE(fault.place().file.ends_with("examples.yaml")) << fault.what();
}

struct Damage {
  const char* what;
  const char* examples;  ///< the file; null: as it is
  std::pair<const char*, const char*> swap;
  const char* message;
};

const Damage damages[] = {
    {"an unknown key of an example",
     "# by hand\nexamples:\n  pull: {lods: []}\n",
     {},
     "examples.yaml:3:10: example `pull` has no key `lods`\n"
     "  did you mean `loads`?"},
    {"no file of that name",
     nullptr,
     {"from: examples.yaml", "from: example.yaml"},
     "capture.yaml:41:18: file of examples is `example.yaml`\n"
     "  there is no such file; did you mean `examples.yaml`?"},
    {"some here and some there",
     nullptr,
     {"{from: examples.yaml}", "{from: examples.yaml, top: {}}"},
     "capture.yaml:41:33: examples has both `from` and `top`\n"
     "  keep all of them in the file, or all of them here"},
    {"a file that names a file",
     "examples: {from: more.yaml}\n",
     {},
     "examples.yaml:1:18: a second file of examples is `more.yaml`\n"
     "  the map itself stands in this file"},
    {"none in it",
     "examples: {}\n",
     {},
     "examples.yaml:1:11: there are no examples\n"
     "  write `examples: {rest: {photos: {CAMERA: FILE}}}`"},
};

TEST(ExamplesFileTest, FaultsAreToldWithTheFileAndItsLine) {
  for (const Damage& damage : damages) {
    CaptureFixture capture;
    part_examples(capture);
    if (damage.examples) capture.write_file("examples.yaml", damage.examples);
    if (damage.swap.first) capture.replace(damage.swap.first, damage.swap.second);
    capture.write();
    EXPECT_EQ(capture.complaint(), damage.message) << damage.what;
  }
}

}  // namespace
}  // namespace hookeye::test
