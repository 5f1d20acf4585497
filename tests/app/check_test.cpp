// hookeye check from outside: sizes in words, signs of measured forces, load cases in another
// order.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <tuple>
#include <vector>

#include "app/cli.h"

namespace hookeye::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Check : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_cube("{z: 1}");
    cube_ = read(folder_ / "capture.yaml");
  }
  /// The cube's capture with the first `what` as `by`.
  std::string with(const std::string& what, const std::string& by) const {
    std::string text = cube_;
    const size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return at == std::string::npos ? text : text.replace(at, what.size(), by);
  }
  /// The cube's capture up to its load cases, and these.
  void write_cases(const std::string& cases) const {
    write("capture.yaml", cube_.substr(0, cube_.find("examples:")) + "examples:\n" + cases);
  }
  /// What `check` prints, and of which it warns.
  Result checked(const std::string& text) const {
    write("capture.yaml", text);
    return hookeye("check .");
  }

  std::string cube_;
};

std::string load_case(const std::string& name, double x, double y, double z,
                      const std::string& measured = "") {
  return fmt::format(R"(  {}:
    supports:
      - {{region: base, fix: [x, y, z]}}
      - {{region: top, move: {{x: {}, y: {}, z: {}}}}}
)",
                     name, x, y, z) +
         (measured.empty() ? "" : "    measured:\n      - " + measured + "\n");
}

TEST_F(Check, TheBodysSizeIsSaidInWords) {
  const Result right = checked(cube_);
  EXPECT_THAT(right.out,
              HasSubstr("the body is 10 mm x 10 mm x 10 mm; of water it would have 1 g"));
  EXPECT_THAT(right.err, Not(HasSubstr("the body is")));
  EXPECT_EQ(json::parse(hookeye("check . --json").out).at("body").at("size"),
            "the body is 10 mm x 10 mm x 10 mm; of water it would have 1 g");
  // The same numbers in metres; the modulus with them, and converted.
  const Result metres = checked(with("length: mm", "length: m"));
  EXPECT_THAT(metres.out,
              HasSubstr("the body is 10 m x 10 m x 10 m; of water it would have 1000 t"));
  EXPECT_THAT(on_one_line(metres.err),
              AllOf(HasSubstr("the body is 17.3 m long"), HasSubstr("not even balloons"),
                    HasSubstr("`units: {length: mm, force: N}`, in which the body is 17.3 mm")));
  cube_ = with("length: mm", "length: m");
  const Result converted = checked(with("mu: 0.05, kappa: 0.5", "mu: 50000, kappa: 500000"));
  EXPECT_THAT(on_one_line(converted.err),
              AllOf(HasSubstr("not even balloons"),
                    HasSubstr("`units: {length: mm, force: N}`, in which the body is 17.3 mm long, "
                              "and moduli in MPa: 50 kPa is 0.05 there")));
}

/// The jaw's force on the body is told as the body's on the jaw.
TEST_F(Check, TheOtherSignOfAllMeasuredForcesIsOneWarning) {
  const auto cases = [](double sign, double sigma, const std::string& region = "top") {
    const auto force = [&](double f) {
      return fmt::format("{{force_on: {}, value: [0, 0, {}], sigma: {}}}", region, sign * f, sigma);
    };
    return load_case("pull", 0, 0, 1, force(1.4)) + load_case("press", 0, 0, -1, force(-1.6));
  };
  const auto said = [&](const std::string& text) {
    write_cases(text);
    const Result result = hookeye("check .");
    EXPECT_EQ(result.status, 0) << result.err;
    return on_one_line(result.err);
  };
  EXPECT_THAT(said(cases(1, 0.01)), Not(HasSubstr("sign")));
  const std::string all = said(cases(-1, 0.01));
  EXPECT_THAT(all, AllOf(HasSubstr("the other sign, as in all 2 examples"),
                         HasSubstr("`value` is what the support exerts on the body, not the body "
                                   "on it: change the sign in all of them")));
  EXPECT_EQ(all.find("the other sign"), all.rfind("the other sign"));
  EXPECT_THAT(said(cases(-1, 1.0)), Not(HasSubstr("sign"))) << "near nothing within sigma";
  EXPECT_THAT(said(cases(-0.001, 0.01)), Not(HasSubstr("sign"))) << "next to nothing";
}

/// A weight that the capture leaves out may be more than what a soft body is pulled by: what all
/// load cases share is taken off.
TEST_F(Check, TheSignIsSeenBesideAWeight) {
  cube_ = with("mu: 0.05, kappa: 0.5", "mu: 0.0005, kappa: 0.005");
  const auto cases = [](double sign) {
    std::string out;
    for (const auto& [name, move, force] :
         {std::tuple("pull", 1.0, 0.014), std::tuple("more", 2.0, 0.027),
          std::tuple("press", -1.0, -0.016)})
      out += load_case(
          name, 0, 0, move,
          fmt::format("{{force_on: top, value: [0, 0, {}], sigma: 0.0005}}", sign * force + 0.005));
    return out;
  };
  write_cases(cases(1));
  EXPECT_THAT(hookeye("check .").err, Not(HasSubstr("sign")));
  write_cases(cases(-1));
  EXPECT_THAT(
      on_one_line(hookeye("check .").err),
      AllOf(HasSubstr("less the mean of all"), HasSubstr("as in all 2 examples where it is sure"),
            HasSubstr("change the sign in all of them")));
}

/// Load cases begin from one another: from which is theirs, and not the file's.
TEST_F(Check, TheOrderOfLoadCasesChangesNothing) {
  constexpr int kCases = 40;
  std::vector<std::string> cases;
  for (int i = 0; i < kCases; ++i)
    cases.push_back(fmt::format(R"(  case_{}:
    supports: [{{region: base, fix: [x, y, z]}}]
    loads: [{{region: top, force: [{}, {}, {}]}}]
    measured: [{{force_on: base, value: [0, 0, -1], sigma: 0.1}}]
)",
                                i, 0.5 * std::cos(0.2 * i), 0.5 * std::sin(0.2 * i),
                                0.2 + 0.02 * i));
  std::vector<size_t> order(cases.size());
  std::iota(order.begin(), order.end(), 0);
  std::map<std::string, json> first;
  std::vector<std::string> warned;
  std::mt19937 engine(5);
  for (int round = 0; round < 3; ++round) {
    std::string text;
    for (const size_t i : order) text += cases[i];
    write_cases(text);
    const Result result = hookeye("check . --json");
    ASSERT_EQ(result.status, 0) << result.err;
    const json seen = json::parse(result.out).at("inspection");
    std::map<std::string, json> guesses;
    for (const json& one : seen.at("first_guess")) guesses[one.at("example")] = one;
    std::vector<std::string> said;
    for (const json& one : seen.at("warnings")) said.push_back(one.at("seen"));
    std::sort(said.begin(), said.end());
    ASSERT_EQ(guesses.size(), cases.size());
    if (round == 0) first = guesses, warned = said;
    EXPECT_EQ(guesses, first);
    EXPECT_EQ(said, warned);
    std::shuffle(order.begin(), order.end(), engine);
  }
}

}  // namespace
}  // namespace hookeye::test
