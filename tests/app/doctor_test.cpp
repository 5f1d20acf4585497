// hookeye doctor, --version, and helpers whose libraries are missing.
#include <gmock/gmock.h>

#include <cstdlib>

#include "app/cli.h"

namespace hookeye::test {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;

class Doctor : public Cli {
 protected:
  void TearDown() override {
    ::unsetenv("HOOKEYE_LIBEXEC");
    Cli::TearDown();
  }

  /// Helpers of its own, all links to those of the build, but `without`.
  fs::path helpers_but(const std::string& without) const {
    const fs::path all = fs::path(HOOKEYE_PROGRAM).parent_path().parent_path() / "libexec/hookeye";
    fs::create_directories(folder_ / "helpers");
    for (const auto& one : fs::directory_iterator(all))
      if (one.path().filename() != without)
        fs::create_symlink(one.path(), folder_ / "helpers" / one.path().filename());
    ::setenv("HOOKEYE_LIBEXEC", (folder_ / "helpers").c_str(), 1);
    return folder_ / "helpers" / without;
  }

  /// A helper as the loader leaves one whose library is not there.
  void write_unloadable(const fs::path& file) const {
    std::ofstream(file)
        << "#!/bin/sh\necho \"$0: error while loading shared libraries: libfar.so.7: "
           "cannot open shared object file\" >&2\nexit 127\n";
    fs::permissions(file, fs::perms::owner_all);
  }
};

TEST_F(Doctor, FindsThisBuildSound) {
  const Result said = hookeye("doctor --json --threads 2");
  ASSERT_EQ(said.status, 0) << said.err;
  const json told = json::parse(said.out);
  EXPECT_EQ(told.at("sound"), true);
  for (const json& helper : told.at("helpers")) {
    EXPECT_EQ(helper.at("there"), helper.at("loads")) << helper;
    EXPECT_TRUE(helper.at("there") || !helper.at("needed")) << helper;
  }
  const json& machine = told.at("machine");
  EXPECT_EQ(machine.at("threads"), 2);
  EXPECT_GE(machine.at("cores"), 1);
  EXPECT_GT(machine.at("memory"), machine.at("memory_free"));
  EXPECT_GT(machine.at("folder_free"), 0);
  EXPECT_THAT(machine.at("blas").at("version"), HasSubstr("OpenBLAS"));
  EXPECT_NE(machine.at("blas").at("kernels"), "");
  EXPECT_TRUE(fs::exists(machine.at("blas").at("file").get<std::string>()));
  EXPECT_THAT(machine.at("embree").at("rays_at_once"), AnyOf(4, 8, 16));
  const json& speed = told.at("speed");
  EXPECT_GT(speed.at("unknowns"), 5000);
  EXPECT_GT(speed.at("equilibria_per_minute"), 0.0);
  EXPECT_GT(speed.at("megapixels_per_second"), 0.0);
  EXPECT_GE(speed.at("seconds"),
            speed.at("equilibria_s").get<double>() + speed.at("pictures_s").get<double>());
}

TEST_F(Doctor, ObeysTheSetOfInstructionsThatIsAskedFor) {
  ::setenv("HOOKEYE_ISA", "sse2", 1);
  const json told = json::parse(hookeye("doctor --fast --json").out);
  ::setenv("HOOKEYE_ISA", "sse9", 1);
  const Result wrong = hookeye("doctor --fast");
  ::unsetenv("HOOKEYE_ISA");
  EXPECT_EQ(told.at("machine").at("embree").at("rays_at_once"), 4);
  EXPECT_EQ(told.at("machine").at("embree").at("isa"), "sse2");
  EXPECT_TRUE(told.at("speed").is_null());
  EXPECT_EQ(wrong.status, 2);
}

TEST_F(Doctor, SaysWhatIsMissingAndWhatMendsIt) {
  const Result whole = hookeye("doctor --fast");
  EXPECT_EQ(whole.status, 0);
  EXPECT_THAT(too_long(whole.out), IsEmpty());
  EXPECT_THAT(whole.out, HasSubstr("all that a capture needs is there"));

  write_unloadable(helpers_but("boards"));
  const Result optional = hookeye("doctor --fast");
  EXPECT_EQ(optional.status, 0);
  EXPECT_THAT(optional.out, HasSubstr("lacks libfar.so.7 (optional): apt-get install"));
  EXPECT_THAT(optional.out, HasSubstr("libopencv-contrib406"));
  EXPECT_THAT(optional.out, HasSubstr("all that a capture needs is there"));
}

TEST_F(Doctor, IsNotSoundWithoutWhatACaptureNeeds) {
  helpers_but("tetgen");
  const Result said = hookeye("doctor --json");
  EXPECT_EQ(said.status, 0);
  const json told = json::parse(said.out);
  EXPECT_EQ(told.at("sound"), false);
  EXPECT_TRUE(told.at("speed").is_null());
  ::setenv("HOOKEYE_LIBEXEC", "/nowhere/at/all", 1);
  EXPECT_EQ(hookeye("doctor --fast").status, 0);
}

/// Not an internal error, and not the file's fault: the library is named.
TEST_F(Doctor, AHelperThatCannotBeLoadedIsToldByItsLibrary) {
  write_unloadable(helpers_but("tetgen"));
  write_cube("{x: 0, y: 0, z: 1}");
  const Result said = hookeye("simulate . -o out");
  EXPECT_EQ(said.status, 2);
  EXPECT_THAT(
      said.err,
      HasSubstr(
          "the helper 'tetgen', which works on this, cannot be loaded: it lacks libfar.so.7"));
  EXPECT_THAT(said.err, HasSubstr("hookeye doctor"));
}

TEST_F(Cli, TheVersionIsAReleaseOrNamesACommit) {
  const Result said = hookeye("--version");
  EXPECT_EQ(said.status, 0);
  EXPECT_THAT(said.out,
              MatchesRegex("hookeye [0-9]+\\.[0-9]+\\.[0-9]+( \\([A-Za-z0-9._+~-]+\\))?\n"));
}

}  // namespace
}  // namespace hookeye::test
