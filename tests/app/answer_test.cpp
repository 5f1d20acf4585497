// The answer first: what a run has found in plain words, from its own files.
#include "runs/report/answer.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "app/cli.h"
#include "estimation/fit/at_floor.h"

namespace hookeye::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;

json timeline(const std::string& verdict, const json& missing, double chi, double held_out) {
  return {{"verdict", verdict},
          {"sentence", "as the search said it"},
          {"missing", missing},
          {"floor", {{"chi", 1.0}, {"source", "rest photos"}}},
          {"steps",
           {{{"name", "base"},
             {"effects", missing},
             {"chi_fit", chi},
             {"chi_validate", held_out},
             {"rms_px_fit", 0.02},
             {"says", {"gravity: self-weight, 9.8 m/s2 towards (0.00, 0.00, -1.00)"}}}}}};
}

std::string sentence(const json& run) { return answer_of(run, {}, {}).at("sentence"); }

TEST(Answer, SaysInPlainWordsWhatIsMissing) {
  EXPECT_EQ(sentence(timeline("explained", {"gravity"}, 1.01, 1.02)),
            "The given model lacks gravity (self-weight, 9.8 m/s2 towards (0.00, 0.00, -1.00)). "
            "With it the model explains the photos down to their noise");
  EXPECT_EQ(sentence(timeline("explained", {"gravity", "creep", "mesh_resolution"}, 1.2, 1.25)),
            "The given model lacks gravity (self-weight, 9.8 m/s2 towards (0.00, 0.00, -1.00)) and "
            "creep. With them on a finer mesh the model explains the photos to 1.20 times the "
            "noise floor (1.25 on held-out photos)");
  EXPECT_EQ(sentence(timeline("explained", json::array(), 1.0, 1.0)),
            "Nothing is missing: the given model explains the photos down to their noise");
  EXPECT_EQ(sentence(timeline("unexplained", json::array(), 3.1, 0.0)),
            "No effect of the catalogue explains what is left: 3.10 times the noise floor");
  EXPECT_EQ(sentence(timeline("unexplained", {"creep"}, 3.1, 4.0)),
            "Creep is missing, but it is not enough: 3.10 times the noise floor (4.00 on held-out "
            "photos) is left, and nothing else of the catalogue explains it");
  EXPECT_EQ(sentence(timeline("unexplained", {"creep"}, 1.21, 1.36)),
            "Creep is missing. It explains the fitted photos (1.21 times the noise floor), but not "
            "yet the held-out ones (1.36; up to 1.3 counts as explained)");
  json untold = timeline("unexplained", json::array(), 3.1, 0.0);
  untold["untold"] = {"stiffness_field", "pressure"};
  EXPECT_EQ(sentence(untold),
            "These photos cannot tell what is missing: 3.10 times the noise floor is left, and "
            "stiffness_field or pressure stand out by more than chance, but not by enough to be "
            "named (`hookeye plan RUN` names views and loads that can tell)");
  json tie = timeline("ambiguous", {"creep"}, 1.0, 1.0);
  tie["tie"] = {"creep", "softening"};
  EXPECT_EQ(sentence(tie),
            "The given model lacks either creep or softening; these photos cannot tell which "
            "(`hookeye plan RUN` names some that can). With one of them the model explains the "
            "photos down to their noise");
  // Photos at the floor and still unexplained: only the search's own sentence says why.
  EXPECT_EQ(sentence(timeline("unexplained", json::array(), 1.05, 1.0)), "As the search said it");
}

/// What was added has its intervals, and the sentence is the step's own.
TEST(Answer, WhatWasAddedHasIntervals) {
  json run = timeline("explained", {"stiffness_field"}, 1.0, 1.0);
  run["steps"][0]["says"] = {
      "stiffness_field: a ball 2 (1.5 to 3) times as stiff as the rest; ranges: 95 %"};
  run["steps"][0]["parameters"] = {
      {{"name", "mu"}, {"value", 0.05}, {"low", 0.04}, {"high", 0.06}, {"unit", "MPa"}},
      {{"name", "stiffness_field.a"},
       {"unit", ""},
       {"long_name", "log of the stiffness factor"},
       {"value", std::log(2.0)},
       {"low", std::log(1.5)},
       {"high", std::log(3.0)}},
      {{"name", "stiffness_field.x"},
       {"unit", "mm"},
       {"long_name", "centre of the place, x"},
       {"value", 4.0},
       {"low", 3.9},
       {"high", 4.1}}};
  EXPECT_THAT(sentence(run),
              HasSubstr("(a ball 2 (1.5 to 3) times as stiff as the rest; ranges: 95 %)"));
  const json effects = answer_of(run, {}, {}).at("effects");
  ASSERT_EQ(effects.size(), 1U);
  const json& values = effects[0].at("values");
  ASSERT_EQ(values.size(), 2U);
  EXPECT_EQ(values[0].at("long_name"), "stiffness factor");
  EXPECT_NEAR(values[0].at("low"), 1.5, 1e-9);
  EXPECT_NEAR(values[0].at("high"), 3.0, 1e-9);
  EXPECT_EQ(values[1].at("name"), "x");
  EXPECT_EQ(values[1].at("low"), 3.9);
}

/// A measured value that no noise explains has a wrong sign or unit more often than a wrong model.
TEST(Answer, AMeasuredValueFarOffIsNamed) {
  const auto misfit = [](double off) {
    const json metrics = {{"measured",
                           {{{"kind", "force_on"},
                             {"region", "grip"},
                             {"example", "pull"},
                             {"over_sigma", {0.2, -off}}},
                            {{"kind", "position_of"}, {"region", ""}, {"over_sigma", {1.0}}}}}};
    return answer_of(timeline("explained", {"gravity"}, 1.0, 1.0), metrics, {})
        .at("misfit")
        .get<std::string>();
  };
  EXPECT_THAT(misfit(31.0), HasSubstr("force_on grip in 'pull' is off by 31: look at its sign and "
                                      "its unit too"));
  EXPECT_THAT(misfit(2.0), testing::Not(HasSubstr("off by 2:")));
}

/// A force that is off by what the body weighs, where the model has no gravity, is no slip of sign.
TEST(Answer, AForceThatIsOffByTheBodysWeightIsSaidToBeSo) {
  const auto misfit = [](std::vector<double> off, const json& weight) {
    json metrics = {{"measured", json::array()}};
    for (size_t i = 0; i < off.size(); ++i)
      for (const double share : {0.75, 0.25})  // of two supports
        metrics["measured"].push_back({{"kind", "force_on"},
                                       {"region", share > 0.5 ? "base" : "grip"},
                                       {"example", fmt::format("load{}", i)},
                                       {"measured", {0.1, 0.0, share * off[i] - 1.0}},
                                       {"predicted", {0.1, 0.0, -1.0}},
                                       {"over_sigma", {0.0, 0.0, share * off[i] / 0.002}}});
    if (!weight.is_null()) metrics["weight"] = weight;
    return answer_of(timeline("explained", {"gravity"}, 1.0, 1.0), metrics, {})
        .at("misfit")
        .get<std::string>();
  };
  const json dense = {{"told", 0.115}, {"of_water", 0.107}, {"unit", "N"}};
  const json water = {{"told", nullptr}, {"of_water", 0.107}, {"unit", "N"}};
  EXPECT_THAT(
      misfit({0.112, 0.05}, dense),
      testing::EndsWith("force_on base in 'load0' is off by 42, by 0.112 N: the body weighs "
                        "0.115 N by its density, and the model has no gravity"));
  EXPECT_THAT(
      misfit({0.112, 0.118}, water),
      testing::EndsWith("force_on base in 'load1' is off by 44, by 0.118 N as in all 2 load "
                        "cases: the body weighs that at 1103 kg/m^3, and the model has "
                        "no gravity"));
  // Part of a weight, or a zero; and what fits nothing.
  const char* zero = "a zero that drifted, or a part of a weight that the model lacks";
  EXPECT_THAT(misfit({0.04, 0.041}, dense), testing::EndsWith(zero));
  EXPECT_THAT(misfit({0.04, 0.041}, json()), testing::EndsWith(zero));
  const char* slip = ": look at its sign and its unit too";
  EXPECT_THAT(misfit({0.112, 0.2}, water), testing::EndsWith(slip));
  EXPECT_THAT(misfit({2.0, -2.0}, dense), testing::EndsWith(slip));
  EXPECT_THAT(misfit({0.112}, json()), testing::EndsWith(slip));
}

TEST(Answer, AStepThatNobodyHasJudgedIsToldByItsFigures) {
  json run = timeline("unexplained", {"gravity"}, 4.33, 4.0);
  run.erase("sentence");
  json answer = answer_of(run, {}, {});
  EXPECT_EQ(answer.at("headline"), "not judged yet");
  EXPECT_THAT(
      answer.at("sentence").get<std::string>(),
      HasSubstr("The model with gravity leaves 4.33 times the noise floor (4.00 on held-out "
                "photos): until that is explained, values and intervals mislead. What may be "
                "missing has not been tested"));
  const json tested = {
      {"effects",
       {{{"effect", "creep"}, {"named", true}}, {{"effect", "swelling"}, {"named", false}}}}};
  answer = answer_of(run, {}, tested);
  EXPECT_EQ(answer.at("headline"), "above the noise floor");
  EXPECT_THAT(answer.at("sentence").get<std::string>(), HasSubstr(". Creep stands out as missing"));
  // One voice: the diagnosis's own sentence, whatever else its table names.
  json tie = tested;
  tie["effects"][1]["named"] = true;
  tie["conclusion"] = "creep stands out as missing, and softening cannot be told from it";
  EXPECT_THAT(answer_of(run, {}, tie).at("sentence").get<std::string>(),
              testing::EndsWith(". Creep stands out as missing, and softening cannot be told from "
                                "it"));
  run["steps"][0]["chi_fit"] = run["steps"][0]["chi_validate"] = 1.02;
  const json camera = {{"most_over_floor",
                        {{"camera", "left"}, {"times", 1.45}, {"use", "fit"}, {"its_own", true}}}};
  answer = answer_of(run, camera, {{"effects", json::array()}});
  EXPECT_EQ(answer.at("headline"), "above the noise floor");
  EXPECT_THAT(
      answer.at("sentence").get<std::string>(),
      HasSubstr("but 1.45 times its own in the fitted photos of camera 'left'. Nothing of the "
                "catalogue stands out"));
  answer = answer_of(run, {}, {{"effects", json::array()}});
  EXPECT_EQ(answer.at("headline"), "at the noise floor");
}

TEST(Answer, TheMisfitTellsPhotosAndForces) {
  const json metrics = {
      {"measured", {{{"over_sigma", {1.0, -1.0, 0.0}}}, {{"over_sigma", {0.0, 0.0, 2.0}}}}}};
  const json answer = answer_of(timeline("explained", json::array(), 1.01, 1.02), metrics, {});
  EXPECT_EQ(answer.at("misfit"),
            "normalised residual 1.010 on fitted photos, 1.020 on held-out ones; noise floor 1.000 "
            "(reference images); surface off by 0.02 px; measured values are met to 1 of their "
            "sigma (RMS of 6 components)");
}

/// A run that is lost or of an earlier version has an answer all the same.
TEST(Answer, WhatIsNotThereIsSaid) {
  EXPECT_EQ(answer_of(json(), {}, {}).at("sentence"), "No step is finished");
  EXPECT_EQ(answer_of({{"steps", json::array()}}, {}, {}).at("headline"), "not judged yet");
  const json answer = answer_of(timeline("explained", json::array(), 1.0, 0.0), {}, {});
  EXPECT_TRUE(answer.at("material").is_null());
  EXPECT_THAT(answer_text(answer), MatchesRegex("verdict: explained\\. .*\nmisfit: .*\n"));
}

/// The material, then the verdict, then the misfit, then all else; also where a report is made.
TEST_F(Cli, TheAnswerComesFirst) {
  write_cube("{z: 1}");
  const std::string text = read(folder_ / "capture.yaml");
  // A force that is measured, and nothing else to fit to.
  write("capture.yaml",
        text + "    measured:\n      - {force_on: top, value: [0, 0, 0.6], sigma: 0.01}\n");
  const Result fitted = hookeye("fit . -o run");
  ASSERT_EQ(fitted.status, 0) << fitted.err;
  EXPECT_THAT(fitted.out, testing::StartsWith("material: neo-hookean\n"));
  EXPECT_THAT(fitted.out,
              ContainsRegex("mu +0\\.[0-9]+ +0\\.[0-9]+ \\.\\. 0\\.[0-9]+ +MPa +shear modulus"));
  EXPECT_THAT(fitted.out, ContainsRegex("kappa +0\\.5 +as given +MPa +bulk modulus"));
  EXPECT_THAT(fitted.out, ContainsRegex("E +0\\.[0-9]+ .*Young's modulus at small strain"));
  EXPECT_THAT(fitted.out, ContainsRegex("nu +0\\.[0-9]+ "));
  EXPECT_THAT(fitted.out, HasSubstr("mu is tied to the measured forces (pull)"));
  const size_t verdict = fitted.out.find("verdict: "), misfit = fitted.out.find("misfit: ");
  EXPECT_LT(fitted.out.find("mu "), verdict);
  EXPECT_LT(verdict, misfit);
  EXPECT_LT(misfit, fitted.out.find("written to"));
  EXPECT_THAT(too_long(fitted.out), IsEmpty());
  const Result reported = hookeye("report run -o report.html");
  if (reported.err.find("without its page") == std::string::npos) {
    EXPECT_EQ(reported.status, 0) << reported.err;
    EXPECT_THAT(reported.out, testing::StartsWith("material: neo-hookean\n"));
  }
  const json document = json::parse(hookeye("fit . -o again --json").out);
  EXPECT_EQ(document.at("answer").at("material").at("cards").at(0).at("law"), "neo-hookean");
  EXPECT_THAT(document.at("answer").at("material").at("yaml").get<std::string>(),
              ContainsRegex("material: \\{law: neo-hookean, mu: 0\\.[0-9]+, kappa: 0\\.5\\}"));
}

}  // namespace
}  // namespace hookeye::test
