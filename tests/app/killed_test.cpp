// A search that is stopped in whatever moment and taken up again: nothing that ended is lost, and
// it comes to the same.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <optional>
#include <random>

#include "app/fitted_run.h"

namespace hookeye::test {
namespace {

class Killed : public WithSmallCapture {
 protected:
  /// Where a search is stopped: once it has kept so many answers, and a moment later.
  struct Stop {
    std::string signal;
    int kept;
    double seconds;
  };

  /// Exit status of the search in `run`; what it worked out to the end is added to `kept_`.
  int search(const std::string& run, const std::string& before = "",
             const std::optional<Stop>& stop = {}) {
    std::string command = fmt::format(
        "{} '{}' discover -v capture -o {} --set search.max_effects=2 >>out.txt "
        "2>err.txt </dev/null",
        before, HOOKEYE_PROGRAM, run);
    if (stop)
      command = fmt::format(
          "{{ {} & }}; program=$!; while kill -0 $program 2>/dev/null && "
          "[ $(grep -c ': kept' <err.txt) -lt {} ]; do sleep 0.01; done; sleep {}; "
          "kill -{} $program; wait $program",
          command, stop->kept, stop->seconds, stop->signal);
    write("search.sh",
          fmt::format("cd '{}'; rm -f err.txt; touch err.txt; {}", folder_.string(), command));
    const int status =
        std::system(fmt::format("sh '{}/search.sh' 2>/dev/null", folder_.string()).c_str());
    std::istringstream lines(read(folder_ / "err.txt"));
    for (std::string line; std::getline(lines, line);)
      for (const char* kind : {"fit", "state", "diagnosis", "trial", "scale"})
        if (line.find(std::string(kind) + ": kept") != std::string::npos) ++kept_[run][kind];
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  int kept_in(const std::string& run) {
    int sum = 0;
    for (const auto& [kind, count] : kept_[run]) sum += count;
    return sum;
  }
  json timeline(const std::string& run) const {
    return json::parse(read(folder_ / run / "run.json"));
  }
  std::map<std::string, std::map<std::string, int>> kept_;
};

TEST_F(Killed, ASearchLosesNothingThatEnded) {
  ASSERT_EQ(search("whole"), 0) << read(folder_ / "err.txt");
  ASSERT_GT(kept_["whole"]["fit"], 2);

  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (const char* signal : {"KILL", "INT", "KILL"}) {
    const int left = kept_in("whole") - kept_in("killed");
    const Stop stop{signal, std::uniform_int_distribution(0, left / 2)(random),
                    std::uniform_real_distribution(0.0, 0.3)(random)};
    const bool one_processor = signal == std::string("INT");
    ASSERT_EQ(search("killed", one_processor ? "taskset 1" : "", stop), one_processor ? 130 : 137)
        << stop.kept << " kept, " << stop.seconds << " s\n"
        << read(folder_ / "err.txt");
  }
  ASSERT_EQ(search("killed"), 0) << read(folder_ / "err.txt");
  // What was under way at a stop is begun again; nothing is done twice, and nothing else is done.
  for (const auto& [kind, count] : kept_["whole"]) EXPECT_LE(kept_["killed"][kind], count) << kind;

  const json whole = timeline("whole"), killed = timeline("killed");
  for (const char* key : {"verdict", "missing", "tie", "search", "sentence", "hint"})
    EXPECT_EQ(killed.at(key), whole.at(key)) << key;
  ASSERT_EQ(killed.at("steps").size(), whole.at("steps").size());
  for (size_t i = 0; i < whole.at("steps").size(); ++i) {
    const json &a = whole.at("steps")[i], &b = killed.at("steps")[i];
    EXPECT_EQ(a.at("name"), b.at("name"));
    ASSERT_EQ(a.at("parameters").size(), b.at("parameters").size());
    for (size_t k = 0; k < a.at("parameters").size(); ++k) {
      const json &was = a.at("parameters")[k], &is = b.at("parameters")[k];
      const double interval = was.at("high").get<double>() - was.at("low").get<double>();
      EXPECT_NEAR(was.at("value"), is.at("value"), 1e-6 * interval) << was.at("name");
    }
    const fs::path pictures =
        folder_ / "killed/steps" / fmt::format("{:02}-{}", i, b.at("name").get<std::string>());
    EXPECT_TRUE(fs::exists(pictures / "diagnosis.json"));
    EXPECT_EQ(fs::exists(pictures / "removed"),
              fs::exists(folder_ / "whole/steps" / pictures.filename() / "removed"));
  }

  // All of it is known now.
  kept_.clear();
  ASSERT_EQ(search("killed", "taskset 1"), 0) << read(folder_ / "err.txt");
  EXPECT_THAT(kept_, testing::IsEmpty());
  EXPECT_EQ(timeline("killed").at("sentence"), killed.at("sentence"));
}

}  // namespace
}  // namespace hookeye::test
