// Ctrl-C: what is finished stays, what is not leaves nothing, and the same command goes on.
#include <gmock/gmock.h>

#include "app/fitted_run.h"

namespace hookeye::test {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

class Interrupted : public WithSmallCapture {
 protected:
  /// Ctrl-C (or another signal) once `sign` stands in what the program has said.
  Result interrupt_at(const std::string& sign, const std::string& arguments,
                      const std::string& signal = "INT") const {
    const std::string command = "cd '" + folder_.string() +
                                "' && rm -f out.txt err.txt && { '" HOOKEYE_PROGRAM "' " +
                                arguments +
                                " >out.txt 2>err.txt </dev/null & } && program=$! && "
                                "while kill -0 $program 2>/dev/null && ! grep -qs '" +
                                sign +
                                "' out.txt err.txt; do sleep 0.02; done; "
                                "kill -" +
                                signal + " $program; wait $program";
    const int status = std::system(("sh -c '" + escaped(command) + "'").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(folder_ / "out.txt"),
            read(folder_ / "err.txt")};
  }
  /// Before there is a model that is said, and how to go on.
  void search_hardly_begun() const {
    const Result stopped = interrupt_at("fit 0/", "discover capture -o early", "TERM");
    ASSERT_EQ(stopped.status, 130) << stopped.out << stopped.err;
    EXPECT_THAT(stopped.out, AllOf(HasSubstr("so far: no model is fitted yet"),
                                   HasSubstr("hookeye discover capture -o early")));
  }
  static std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out;
  }
  /// A search stopped after its first step goes on from there, to the one more that it may add.
  void search() const {
    const std::string search = "discover capture -o search --set search.max_effects=1";
    const Result stopped = interrupt_at("step base: normalised", search);
    ASSERT_EQ(stopped.status, 130) << stopped.out << stopped.err;
    const fs::path model = folder_ / "search/steps/00-base/model.yaml";
    ASSERT_TRUE(fs::exists(model));
    const auto written = fs::last_write_time(model);
    EXPECT_FALSE(json::parse(read(folder_ / "search/run.json")).contains("verdict"));
    EXPECT_THAT(stopped.out,
                AllOf(HasSubstr("so far, with nothing settled"), HasSubstr("material: neo-hookean"),
                      HasSubstr("step, base: normalised residual"), HasSubstr("noise floor"),
                      HasSubstr("run: search"), HasSubstr("hookeye discover capture -o search")));
    EXPECT_THAT(stopped.out, Not(AnyOf(HasSubstr("verdict"), HasSubstr("explained"))));
    const Result resumed = hookeye(search);
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_EQ(fs::last_write_time(model), written) << "the base model was fitted again";
    const json timeline = json::parse(read(folder_ / "search/run.json"));
    EXPECT_TRUE(timeline.contains("verdict"));
    EXPECT_GT(timeline.at("steps").size(), 1U);
  }
  /// Everything in a folder, by name.
  static std::vector<std::string> files(const fs::path& folder) {
    std::vector<std::string> out;
    if (fs::exists(folder))
      for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) out.push_back(fs::relative(entry, folder));
    std::sort(out.begin(), out.end());
    return out;
  }
};

TEST_F(Interrupted, AFitIsDoneAnewAndASearchGoesOn) {
  const Result stopped = interrupt_at("fit 0/", "fit capture -o run");
  ASSERT_EQ(stopped.status, 130) << stopped.out << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("stopping; all that is finished is kept"));
  EXPECT_FALSE(fs::exists(folder_ / "run/steps/00-base"));
  for (const std::string& file : files(folder_ / "run"))
    EXPECT_THAT(file, AnyOf("run.json", ".lock"));
  const Result ended = interrupt_at("fit 0/", "fit capture -o run", "TERM");
  ASSERT_EQ(ended.status, 130) << ended.out << ended.err;
  ASSERT_EQ(hookeye("fit capture -o run").status, 0);
  ASSERT_EQ(hookeye("fit capture -o whole").status, 0);
  EXPECT_EQ(files(folder_ / "run"), files(folder_ / "whole"));
  const auto chi = [&](const char* run) {
    return json::parse(read(folder_ / run / "steps/00-base/metrics.json"))
        .at("chi_fit")
        .get<double>();
  };
  EXPECT_NEAR(chi("run"), chi("whole"), 1e-6 * chi("whole"));  // sums of threads: last digits
  search();
  search_hardly_begun();
}

}  // namespace
}  // namespace hookeye::test
