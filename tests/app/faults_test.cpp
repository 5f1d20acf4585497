// What is most likely not meant is said; what cannot be done ends in one sentence and exit 2.
#include <gmock/gmock.h>

#include "app/fitted_run.h"

namespace hookeye::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class Faults : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_cube("{x: 0, y: 0, z: 1}");
  }
  /// The cube's capture with `what` replaced, or with lines more at its end.
  void change(const std::string& what, const std::string& by) const {
    std::string text = read(folder_ / "capture.yaml");
    ASSERT_NE(text.find(what), std::string::npos);
    write("capture.yaml", text.replace(text.find(what), what.size(), by));
  }
  void add(const std::string& lines) const {
    write("capture.yaml", read(folder_ / "capture.yaml") + lines);
  }
};

TEST_F(Faults, ResultsThatCannotBeWrittenAreNoInternalErrors) {
  write("file", "not a folder");
  for (const std::string arguments :
       {"simulate . -o file/out", "mesh cube.obj -o file/body.vtu",
        "synth " HOOKEYE_SOURCE_DIR "/sample_scenes/sample.yaml -o file/out"}) {
    const Result result = hookeye(arguments);
    EXPECT_EQ(result.status, 2) << arguments << "\n" << result.err;
    EXPECT_THAT(result.err, AllOf(HasSubstr("file"), HasSubstr("Not a directory"),
                                  Not(HasSubstr("internal error"))))
        << arguments;
  }
}

TEST_F(Faults, AnOutputThatIsFullIsToldWhateverWasPrinted) {
  for (const char* command : {"check . > /dev/full", "check . --json > /dev/full"}) {
    const std::string all = "cd '" + folder_.string() + "' && '" HOOKEYE_PROGRAM "' " + command +
                            " 2>err.txt </dev/null";
    const int status = std::system(all.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 2) << command;
    EXPECT_THAT(read(folder_ / "err.txt"), HasSubstr("standard output: this cannot be written to"));
  }
}

TEST_F(Faults, SupportsThatContradictEachOtherAreTold) {
  EXPECT_THAT(hookeye("check .").err, Not(HasSubstr("share")));
  change("top: {box: [[-1, -1, 9.9]", "top: {box: [[-1, -1, -0.1]");
  const Result result = hookeye("check .");
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, HasSubstr("example pull: the supports `base` and `top` share"));
}

TEST_F(Faults, MeasurementsOffTheBodyOrItsSupportsAreTold) {
  change("  top: {box", "  side: {box: [[9.9, 1, 1], [10.1, 9, 9]]}\n  top: {box");
  add("    measured:\n"
      "      - {position_of: [5, 5, 10.01], value: [5, 5, 11], sigma: 0.01}\n"
      "      - {force_on: top, value: [0, 0, 1], sigma: 0.01}\n");
  EXPECT_EQ(hookeye("check .").err.find("measured"), std::string::npos);
  add("      - {position_of: [5, 5, 100], value: [5, 5, 11], sigma: 0.01}\n"
      "      - {force_on: side, value: [0, 0, 1], sigma: 0.01}\n");
  const Result result = hookeye("check .");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("lies 90 mm off the body"),
                                HasSubstr("a force is measured on `side`")));
}

TEST_F(Faults, WhatCannotBeIsToldInFull) {
  const std::string text = read(folder_ / "capture.yaml");
  const struct {
    std::string what, by, err;
  } faults[] = {
      {"top: {box: [[-1, -1, 9.9], [11, 11, 10.1]]}", "top: {box: [[20, 20, 20], [30, 30, 30]]}",
       "./capture.yaml:12:3: region 'top' selects no point of the surface\n"
       "  a patch of the body, which reaches from (0, 0, 0) to (10, 10, 10)\n"},
      {"mu: 0.05", "mu: -0.05",
       "./capture.yaml:8:36: `mu` is -0.05\n"
       "  a number above 0\n"}};
  for (const auto& fault : faults) {
    write("capture.yaml", text);
    change(fault.what, fault.by);
    const Result result = hookeye("check .");
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err, fault.err);
  }
}

/// No error: a body that is free may swell where it lies. But it is hardly meant.
TEST_F(Faults, AFreeRigidMotionIsTold) {
  write_cube("{z: 1}");
  change("fix: [x, y, z]", "fix: [z]");
  const Result result = hookeye("check .");
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(
      result.err,
      "warning: no force is known (no load, no measured force, no weight): the values fix "
      "only ratios of stiffness, not its size\n"
      "warning: ./capture.yaml:14:3: example pull leaves the body free: rotation about (0, 0, 1) "
      "through (5, 5, 5); translation along (1, 0, 0); translation along (0, 1, 0); tell its "
      "`supports`\n"
      "warning: no example is held out (use: validate): nothing will judge the fit from "
      "outside\n");
}

/// Published Yeoh constants have such signs; what they mean must be known where the body goes.
TEST_F(Faults, AMaterialWhoseEnergyFallsAgainIsTold) {
  change("law: neo-hookean, mu: 0.05", "law: yeoh, c1: 0.05, c2: 0, c3: -0.001");
  change("fit: [mu]", "fit: [c1]");
  const Result result = hookeye("check .");
  EXPECT_EQ(result.status, 0);
  // dW/dI1 = c1 + 3 c3 (I1 - 3)^2 = 0 at I1 = 7.0825, l^2 + 2/l: l = 2.510 and 0.286
  EXPECT_THAT(result.err, AllOf(HasSubstr("this yeoh falls again from a stretch of 2.5"),
                                HasSubstr("this yeoh falls again from a stretch of 0.28"),
                                ContainsRegex("capture.yaml:[0-9]+:[0-9]+: material: the energy")));
  change("c3: -0.001", "c3: 0.001");
  EXPECT_THAT(hookeye("check .").err, Not(HasSubstr("falls again")));
}

/// Nothing is mended in silence.
TEST_F(Faults, ARoundedMaterialFrameIsTold) {
  const std::string law = "law: neo-hookean, mu: 0.05, kappa: 0.5}\n  fit: [mu]";
  change(law,
         "law: additive, frame: [[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]], "
         "I1bar: {at: [0], stiffness: [0.05]}, J: {at: [0], stiffness: [0.5]}}\n"
         "  fit: [additive]");
  EXPECT_THAT(hookeye("check .").err, Not(HasSubstr("orthonormal")));
  change("0.8, 0.6, 0], [-0.6", "0.8001, 0.6, 0], [-0.6");
  const Result rounded = hookeye("check .");
  EXPECT_EQ(rounded.status, 0) << rounded.err;
  EXPECT_THAT(rounded.err, HasSubstr("the axes of `frame` are orthonormal to 0.0002 only"));
  change("0.8001", "0.81");
  EXPECT_THAT(hookeye("check .").err, HasSubstr("the material frame is not orthonormal"));
}

using FaultsOfPhotos = FittedRun;

/// It is no success: the step stands, and the status and every later look say what it is.
TEST_F(FaultsOfPhotos, AFitThatStopsEarlyIsNoSuccess) {
  const Result stopped = hookeye("fit capture -o early --iterations 1");
  EXPECT_EQ(stopped.status, 3);
  EXPECT_THAT(stopped.err, HasSubstr("the fit has not converged"));
  EXPECT_THAT(stopped.err, HasSubstr("-m "));
  ASSERT_TRUE(fs::exists(folder_ / "early/steps/00-base/model.yaml"));
  const Result compared = hookeye("compare early --json");
  EXPECT_EQ(compared.status, 0);
  EXPECT_THAT(json::parse(compared.out)["warnings"].dump(), HasSubstr("has not converged"));
  const Result onward = hookeye("fit capture -o late -m early/steps/00-base/model.yaml");
  EXPECT_EQ(onward.status, 0) << onward.err;
  EXPECT_THAT(hookeye("fit capture -o late -m early/steps/00-base/model.yaml").err,
              HasSubstr("is fitted already, from another start"));
}

/// Steps made from one set of photos say nothing of another.
TEST_F(FaultsOfPhotos, AnotherPhotoNeedsAnotherRun) {
  fs::copy_file(folder_ / "capture/photos/rest_cam0.png", folder_ / "capture/photos/pull_cam0.png",
                fs::copy_options::overwrite_existing);
  for (const char* command : {"discover capture -o run", "diagnose run", "add run gravity"}) {
    const Result result = hookeye(command);
    EXPECT_EQ(result.status, 2) << command;
    EXPECT_THAT(result.err, HasSubstr("pull_cam0.png: this has changed since the run")) << command;
  }
}

TEST_F(FaultsOfPhotos, WarningsAreInTheDocument) {
  const Result fitted = hookeye("fit capture -o again --json");
  EXPECT_EQ(fitted.status, 0) << fitted.err;
  EXPECT_THAT(json::parse(fitted.out)["warnings"].dump(), HasSubstr("plane faces"));
  EXPECT_THAT(json::parse(fitted.out)["steps"].size(), 1u);
}

TEST_F(FaultsOfPhotos, AFileCutInHalfIsToldWhereTheCaptureNamesIt) {
  const std::string text = read(folder_ / "capture/capture.yaml");
  for (const std::string name : {"photos/pull_cam0.png", "albedo.png"}) {
    const fs::path picture = folder_ / "capture" / name;
    ASSERT_TRUE(fs::exists(picture));
    const std::string whole = read(picture);
    fs::resize_file(picture, whole.size() / 2);
    const size_t at = text.find(name);
    ASSERT_NE(at, std::string::npos);
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n');
    const auto column = at - text.rfind('\n', at);
    for (const char* command : {"check capture", "fit capture -o again"}) {
      const Result result = hookeye(command);
      EXPECT_EQ(result.status, 2) << command;
      EXPECT_EQ(result.err, "capture/capture.yaml:" + std::to_string(line) + ":" +
                                std::to_string(column) + ": " + picture.filename().string() +
                                ": the picture is truncated or damaged\n"
                                "  hand over a complete PNG, TIFF, JPEG or EXR picture\n")
          << command;
      EXPECT_FALSE(fs::exists(folder_ / "again"));
    }
    write("capture/" + name, whole);
  }
}

TEST_F(FaultsOfPhotos, NoiseThatAPhotoHardlyTellsIsToldOf) {
  EXPECT_THAT(hookeye("check capture").err, Not(HasSubstr("noise")));
  std::string text = read(folder_ / "capture/capture.yaml");
  const size_t at = text.find("  noise: {full_well");
  ASSERT_NE(at, std::string::npos);
  write("capture/capture.yaml", text.erase(at, text.find('\n', at) + 1 - at));
  const Result result = hookeye("check capture");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, ContainsRegex("example rest, photo cam0: noise estimated as 0.0[0-9]+ at "
                                        "half of full scale .and that of 2 more., but a small"));
}

TEST_F(Faults, AMeshFarTooFineIsRefusedAtOnce) {
  const Result result = hookeye("mesh cube.obj -o body.vtu --edge 0.01");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("million tetrahedra"), HasSubstr("edge of at least")));
  EXPECT_FALSE(fs::exists(folder_ / "body.vtu"));
}

}  // namespace
}  // namespace hookeye::test
