// The program as it is run: the same answer with other instructions, with one thread, and of a
// whole search of the capture told otherwise in every way at once.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <regex>

#include "core/text_file.h"
#include "tests/invariance/leaning_blob.h"
#include "tests/invariance/transformed.h"
#include "tests/support/temporary_folder.h"

namespace hookeye::test {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Way {
  std::string verb = "fit";  ///< and its options
  std::string isa = {};      ///< HOOKEYE_ISA; empty: the best
  int threads = 2;
};

/// The run's timeline; null where the processor has no such instructions.
json timeline_of(const fs::path& capture, const Way& way) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out", err = folder / "err";
  const int status = std::system(
      fmt::format("HOOKEYE_ISA={} '{}' {} --json '{}' -o '{}' --threads {} >'{}' 2>'{}' </dev/null",
                  way.isa, HOOKEYE_PROGRAM, way.verb, capture.string(), (folder / "run").string(),
                  way.threads, out.string(), err.string())
          .c_str());
  const std::string said = read_text(err);
  if (said.find("this processor has no") != std::string::npos) return {};
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw std::runtime_error(fmt::format("{} ended with {}: {}", way.verb, status, said));
  return json::parse(read_text(out));
}

const json& last_step(const json& timeline) { return timeline.at("steps").back(); }

double value(const json& step, const std::string& name, const char* what = "value") {
  for (const json& parameter : step.at("parameters"))
    if (parameter.at("name") == name) return parameter.at(what).get<double>();
  throw std::runtime_error("no parameter " + name);
}

/// Values over the width of their intervals, the largest difference.
double off_by_intervals(const json& now, const json& was) {
  double most = 0.0;
  for (const json& parameter : was.at("parameters")) {
    const std::string name = parameter.at("name");
    const double width = value(was, name, "high") - value(was, name, "low");
    most = std::max(most, std::abs(value(now, name) - value(was, name)) / width);
  }
  return most;
}

/// Of an interval, over its value.
double width(const json& step, const std::string& name) {
  return (value(step, name, "high") - value(step, name, "low")) / std::abs(value(step, name));
}

/// Numbers struck: words that do not depend on the frame.
std::string words(const json& step) {
  static const std::regex number(R"(-?\b\d+(\.\d+)?(e[-+]?\d+)?\b)");
  std::string all;
  for (const json& said : step.at("says")) all += said.get<std::string>() + "\n";
  return std::regex_replace(all, number, "#");
}

/// Other vectors round pictures otherwise, in the last digit of a float; one thread, nothing.
TEST(Program, FitsTheSameWithAnyInstructionsAndThreads) {
  const json first = timeline_of(first_telling(), {});
  const json& was = last_step(first);
  int others = 0;
  for (const Way& way : {Way{.threads = 1}, Way{.isa = "sse2"}, Way{.isa = "avx"},
                         Way{.isa = "avx2"}, Way{.isa = "avx512"}}) {
    const json told = timeline_of(first_telling(), way);
    if (told.is_null()) continue;
    others += !way.isa.empty();
    const json& now = last_step(told);
    const double chi = now.at("chi_fit").get<double>() / was.at("chi_fit").get<double>() - 1.0;
    const double off = off_by_intervals(now, was);
    fmt::print("{:7} {} threads: chi off by {:+.1e}, values by {:.1e} of their intervals\n",
               way.isa, way.threads, chi, off);
    EXPECT_LT(std::abs(chi), way.isa.empty() ? 1e-12 : 1e-5) << way.isa;
    EXPECT_LT(off, way.isa.empty() ? 1e-9 : 0.02) << way.isa;
  }
  EXPECT_GE(others, 1) << "every processor has sse2";
}

/// All at once: another frame, other units, another order, other instructions, one thread.
TEST(Program, SearchesTheSame) {
  Frame frame = turned(3);
  frame.move = {-120.0, 200.0, 180.0};
  frame.length = in_metres().length;
  frame.length_unit = in_metres().length_unit;
  const Order order{.nodes = 1, .vertices = 1, .cameras = 2, .examples = 3, .regions = 2};
  const TemporaryFolder folder;
  write_transformed(first_telling(), folder / "capture", frame, order);
  const Way way{.verb = "discover --without mesh_resolution"};
  const json first = timeline_of(first_telling(), way);
  const json otherwise =
      timeline_of(folder / "capture", {.verb = way.verb, .isa = "sse2", .threads = 1});
  EXPECT_EQ(first.at("missing"), json::array({"gravity"}));
  EXPECT_EQ(first.at("verdict"), "explained");
  EXPECT_EQ(otherwise.at("missing"), first.at("missing"));
  EXPECT_EQ(otherwise.at("verdict"), first.at("verdict"));
  const json &was = last_step(first), &now = last_step(otherwise);
  EXPECT_EQ(words(now), words(was));
  const auto gravity = [](const json& step) {
    return Vector3d(value(step, "gravity.x"), value(step, "gravity.y"), value(step, "gravity.z"));
  };
  const Vector3d expected = frame.length * (frame.R * gravity(was));
  const double chi = now.at("chi_fit").get<double>() / was.at("chi_fit").get<double>() - 1.0;
  const double mu = value(now, "mu") / (frame.stress() * value(was, "mu")) - 1.0;
  const double off = (gravity(now) - expected).norm() / expected.norm();
  fmt::print("{}: chi off by {:+.1e}, mu by {:+.1e}, gravity by {:.1e}\n{}",
             first.at("missing").dump(), chi, mu, off, words(was));
  // Two fits end a fortieth of an interval from each other (telling_test.cpp); intervals are 0.2 %
  // of mu and 2 % of the weight. Where a value is off by that, a sum of squares is by 0.01 of some
  // 1e4 pixels.
  EXPECT_LT(std::abs(mu), 0.025 * width(was, "mu"));
  EXPECT_LT(off, 0.025 * width(was, "gravity.z"));
  EXPECT_LT(std::abs(chi), 1e-4);
}

}  // namespace

}  // namespace hookeye::test
