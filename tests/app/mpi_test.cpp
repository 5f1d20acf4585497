// hookeye-mpi: load cases shared among processes change no bit of the answer.
#include <gmock/gmock.h>

#include <regex>

#include "app/fitted_run.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class Mpi : public WithSmallCapture {
 protected:
  /// Where mpirun starts nothing at all (no network, no shell for it), that is no fault of ours.
  void SetUp() override {
    Cli::SetUp();
    const Result started = shell(mpirun(2) + "true");
    if (started.status != 0) GTEST_SKIP() << "NOT RUN: mpirun starts nothing here: " << started.err;
    Cli::TearDown();
    WithSmallCapture::SetUp();
  }

  /// Of Open MPI: more processes than cores, as root, without what containers forbid.
  static std::string mpirun(int processes) {
    return "env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
           "OMPI_MCA_btl_vader_single_copy_mechanism=none '" HOOKEYE_MPIRUN
           "' --oversubscribe --mca mpi_yield_when_idle 1 -n " +
           std::to_string(processes) + " ";
  }
  Result shell(const std::string& command) const {
    const std::string whole =
        "cd '" + folder_.string() + "' && " + command + " >out.txt 2>err.txt </dev/null";
    const int status = std::system(whole.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(folder_ / "out.txt"),
            read(folder_ / "err.txt")};
  }
  Result shared(int processes, const std::string& arguments) const {
    return shell(mpirun(processes) + "'" HOOKEYE_MPI_PROGRAM "' --threads 1 " + arguments);
  }
  /// One effect is enough: it is named after a fit, trials, refits and a finer mesh.
  void write_search(const std::string& run, int processes) const {
    const std::string search = "discover capture --set search.max_effects=1 -o " + run;
    const Result found =
        processes == 0 ? hookeye("--threads 1 " + search) : shared(processes, search);
    ASSERT_EQ(found.status, 0) << found.out << found.err;
  }
  /// Files of a run that hold its numbers, by name; what they tell of time and place is struck.
  std::map<std::string, std::string> numbers(const std::string& run) const {
    static const std::regex passing(
        R"re("(time|seconds|cpu_s|cpu|wall|started|ended|command|version)": *("[^"]*"|[-0-9.e+]+))re");
    std::map<std::string, std::string> out;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / run)) {
      const std::string name = entry.path().filename();
      if (name == "model.yaml" || name == "metrics.json" || name == "decisions.jsonl" ||
          name == "diagnosis.json")
        out[fs::relative(entry.path(), folder_ / run)] =
            std::regex_replace(read(entry.path()), passing, "");
    }
    return out;
  }
};

TEST_F(Mpi, ThreeProcessesFindTheSameBits) {
  write_search("alone", 0);
  const auto expected = numbers("alone");
  ASSERT_GT(expected.size(), 5U);
  write_search("together", 3);
  EXPECT_EQ(numbers("together"), expected);
}

TEST_F(Mpi, SolvesAndDiagnosesTogether) {
  for (const std::string verb : {"fit capture -o ", "simulate capture -o "}) {
    ASSERT_EQ(hookeye("--threads 1 " + verb + "alone").status, 0);
    const Result result = shared(2, verb + "together");
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("2 processes share the load cases, each on 1 core"));
  }
  EXPECT_EQ(read(folder_ / "together/deformed/pull.vtu"),
            read(folder_ / "alone/deformed/pull.vtu"));
  ASSERT_EQ(hookeye("--threads 1 diagnose alone").status, 0);
  const Result diagnosed = shared(2, "diagnose together");
  ASSERT_EQ(diagnosed.status, 0) << diagnosed.err;
  EXPECT_EQ(numbers("together"), numbers("alone"));
}

/// Photos whose texture is another load case's hang on its equilibrium, too.
TEST_F(Mpi, ATextureFromPhotosIsSeenByAll) {
  const std::regex texture("texture: \\{[^}]*\\}");
  const std::string told = read(folder_ / "capture/capture.yaml");
  ASSERT_TRUE(std::regex_search(told, texture)) << told;
  write("capture/capture.yaml", std::regex_replace(told, texture, "texture: {from: rest}"));
  ASSERT_EQ(hookeye("--threads 1 fit capture -o alone").status, 0);
  const Result fitted = shared(3, "fit capture -o together");
  ASSERT_EQ(fitted.status, 0) << fitted.err;
  EXPECT_EQ(numbers("together"), numbers("alone"));
}

TEST_F(Mpi, SolverIsChosen) {
  const auto simulated = [&](const std::string& solver) {
    return shared(1, "simulate capture -o " + solver + " --json -v --solver " + solver);
  };
  const auto moved = [](const Result& result) {
    const json document = json::parse(result.out);
    double most = 0.0;  // the body at rest is an example, too
    for (const auto& example : document.at("examples"))
      most = std::max(most, example.at("max_displacement").get<double>());
    return most;
  };
  const Result direct = simulated("direct"), multigrid = simulated("multigrid");
  ASSERT_EQ(direct.status, 0) << direct.err;
  EXPECT_THAT(direct.err, Not(HasSubstr("iterations to")));
#ifdef HOOKEYE_PETSC
  ASSERT_EQ(multigrid.status, 0) << multigrid.err;
  EXPECT_THAT(multigrid.err, HasSubstr("iterations to"));
  EXPECT_GT(moved(direct), 0.0);
  EXPECT_NEAR(moved(multigrid), moved(direct), 1e-8 * moved(direct));
#else
  EXPECT_EQ(multigrid.status, 2);
  EXPECT_THAT(multigrid.err, HasSubstr("this hookeye-mpi was built without PETSc"));
#endif
  const Result wrong = simulated("fast");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("fast not in {auto,direct,multigrid}"));
}

TEST_F(Mpi, BadInputIsToldOnce) {
  const Result result = shared(3, "fit nowhere -o run");
  EXPECT_EQ(result.status, 2) << result.err;
  const size_t first = result.err.find("nowhere");
  ASSERT_NE(first, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find("is not there", result.err.find("is not there") + 1), std::string::npos)
      << result.err;
  const Result other = shared(2, "check capture");
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("there is no command `check`"));
}

/// One that is killed ends all, with a message, and the search goes on from what was finished.
TEST_F(Mpi, ADeadProcessEndsTheOthersAndTheRunGoesOn) {
  const Result killed = shell(
      mpirun(2) +
      "sh -c 'if [ \"$OMPI_COMM_WORLD_RANK\" = 1 ]; then (while ! ls "
      "killed/steps/00-base/model.yaml >/dev/null 2>&1; do sleep 0.05; done; kill -9 $$) & fi; "
      "exec \"" HOOKEYE_MPI_PROGRAM
      "\" --threads 1 discover capture --set search.max_effects=1 -o killed'");
  EXPECT_NE(killed.status, 0);
  EXPECT_THAT(killed.err, HasSubstr("signal 9"));
  ASSERT_TRUE(fs::exists(folder_ / "killed/steps/00-base/model.yaml"));
  EXPECT_FALSE(json::parse(read(folder_ / "killed/run.json")).contains("verdict"));
  write_search("killed", 2);
  EXPECT_TRUE(json::parse(read(folder_ / "killed/run.json")).contains("verdict"));
}

}  // namespace
}  // namespace hookeye::test
