// What is said on a terminal of 100 columns.
#include "runs/text.h"

#include <gmock/gmock.h>

#include "app/cli.h"
#include "estimation/diagnosis/diagnosis_json.h"
#include "estimation/output/step_json.h"
#include "runs/tables.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(Text, AShortTableIsAlignedAndUnbroken) {
  EXPECT_EQ(table({{"name", "chi"}, {"pull", "1.25"}, {"°", ""}}),
            "  name  chi\n  pull  1.25\n  °\n");
}

TEST(Text, AWideTableGoesOnBelowAndLosesNothing) {
  const std::string sentence =
      "one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen "
      "sixteen seventeen";
  const std::string text = table({{"first", "second"}, {std::string(150, '@'), sentence}});
  EXPECT_THAT(too_long(text), IsEmpty());
  EXPECT_EQ(std::count(text.begin(), text.end(), '@'), 150);
  std::istringstream words(sentence);
  for (std::string word; words >> word;) EXPECT_THAT(text, HasSubstr(word));
}

TEST(Text, SentencesAreBrokenBetweenWordsAndIndented) {
  EXPECT_EQ(wrapped("a short one", 2), "  a short one\n");
  EXPECT_EQ(wrapped("alpha beta gamma", 2, 12), "  alpha\n    beta\n    gamma\n");
  EXPECT_EQ(wrapped("see /a/path/that/is/long", 0, 12), "see\n  /a/path/that/is/long\n");
}

TEST(Text, HtmlTakesAnyText) {
  EXPECT_EQ(html_text("a<b> & \"c\""), "a&lt;b&gt; &amp; &quot;c&quot;");
}

TEST(Text, ABarShowsWhereTheFloorIs) {
  EXPECT_EQ(marked_bar(4.0, 1.0, 4.0, 8), "##|######");
  EXPECT_EQ(marked_bar(1.0, 2.0, 4.0, 8), "##..|....");
  EXPECT_EQ(marked_bar(0.0, 0.0, 0.0, 4), "|....");
}

TEST(Text, ADiagnosisFitsAHundredColumns) {
  Diagnosis diagnosis;
  for (const char* name :
       {"tension_compression_asymmetry", "strain_stiffening", "stiffness_field"}) {
    EffectScore score;
    score.effect = name;
    score.evidence = 100000.0;
    score.explains = 0.9;
    score.fall = 100.0;
    score.p_value = 0.0;
    score.confused_with = {
        {diagnosis.effects.empty() ? "swelling" : "tension_compression_asymmetry", 0.9},
        {"an_effect_with_a_long_name", 0.9},
        {"compressible_foam", 0.9},
        {"gravity", 0.9}};
    for (int i = 0; i < 30; ++i) score.why += "a word or two ";
    diagnosis.effects.push_back(score);
  }
  diagnosis.effects.back().testable = false;
  diagnosis.effects.back().why_not = diagnosis.effects.back().why;
  const std::string text = diagnosis_table(diagnosis, "photos");
  EXPECT_THAT(too_long(text), IsEmpty());
  EXPECT_THAT(text, HasSubstr("swelling +3\n"));
  EXPECT_THAT(text, HasSubstr("  tension_compression_asymmetry  "));
  EXPECT_THAT(text, HasSubstr("  tension_compression_asymmetry\n"));
  EXPECT_THAT(text, HasSubstr("a word or two"));
}

/// Photos that are blurred from rest on are at "the floor" of such photos.
TEST(Text, AFloorFarAboveTheToldNoiseIsTold) {
  const auto told = [](double chi, const char* source, std::map<std::string, double> by_camera) {
    Floor floor;
    floor.chi = chi, floor.source = source, floor.by_camera = std::move(by_camera);
    return high_floor(floor);
  };
  EXPECT_EQ(told(2.4, "rest photos", {}), "");
  EXPECT_EQ(told(5.44, "noise model", {}), "");
  EXPECT_THAT(told(5.44, "rest photos", {}), HasSubstr("5.44 times the specified noise"));
  EXPECT_EQ(told(2.4, "rest photos", {{"left", 2.9}}), "");
  EXPECT_THAT(told(2.79, "rest photos", {{"left", 1.04}, {"right", 4.49}}),
              HasSubstr("of camera 'right' itself is 4.49 times"));
}

/// Effects that stood out are told whether they were tried or not.
TEST(Text, AChoiceTellsWhoWasNotTried) {
  const auto before = nlohmann::json::parse(R"({"diagnosis": [
      {"effect": "gravity", "evidence": 365.3, "confusion": []},
      {"effect": "pressure", "evidence": 89.2,
       "confusion": [{"effect": "gravity", "cosine": 0.997}]},
      {"effect": "creep", "evidence": 2.0}]})");
  auto step = nlohmann::json::parse(R"({"added": "gravity", "chi_fit": 1.0, "raced": [
      {"effect": "gravity", "chi_fit": 0.5, "chi_validate": 0.5, "floor": 0.5}]})");
  const std::string text = choice_table(before, step, 1.0, {}, "photos");
  EXPECT_THAT(text, testing::ContainsRegex("gravity +365.3 +1.00 +1.00"));
  EXPECT_THAT(text, testing::ContainsRegex("pressure +89.2 +-"));
  EXPECT_THAT(text, testing::Not(HasSubstr("creep")));
  EXPECT_THAT(text, HasSubstr("no other was refitted"));
  // The floor of half-size pictures is rough: 0.8 of it is not better than noise.
  step["raced"][0]["chi_fit"] = 0.4;
  EXPECT_THAT(choice_table(before, step, 1.0, {}, "photos"),
              testing::ContainsRegex("gravity +365.3 +floor +1.00"));
  EXPECT_THAT(choice_table(before, step, 1.0, {}, "photos"), HasSubstr("floor: less than that"));
  step["raced"][0].erase("floor");
  EXPECT_THAT(choice_table(before, step, 1.0, {}, "photos"),
              testing::AllOf(testing::ContainsRegex("gravity +365.3 +0.40\\* +0.50\\*"),
                             HasSubstr("*: the residual itself")));
  step["raced"][0]["floor"] = 0.5;
  EXPECT_THAT(text, HasSubstr("to first order no other"));
  step["added"] = step["raced"][0]["effect"] = "mesh_resolution";  // settled alone: no choice
  EXPECT_EQ(choice_table(before, step, 1.0, {}, "photos"), "");
}

/// What can imitate the added effect, not what it can imitate; odds that a likelihood can tell.
TEST(Text, AChoiceTellsWhatElseItCouldHaveBeen) {
  const auto before = nlohmann::json::parse(R"({"diagnosis": [
      {"effect": "gravity", "evidence": 16.9, "confusion": [{"effect": "swelling", "cosine": 0.931}]},
      {"effect": "pressure", "evidence": 16.7, "confusion": [{"effect": "gravity", "cosine": 0.99}]}
      ]})");
  auto step = nlohmann::json::parse(R"({"added": "gravity", "chi_fit": 1.0,
      "raced": [{"effect": "gravity", "chi_fit": 0.5, "chi_validate": 0.5, "floor": 0.5}],
      "rivals": [{"effect": "gravity", "score": 0.0}, {"effect": "pressure", "score": -5.3}]})");
  const std::string near = choice_table(before, step, 1.0, {}, "photos");
  EXPECT_THAT(near, HasSubstr("pressure, the next, is behind by 5.3: odds of 200 to one"));
  EXPECT_THAT(near, HasSubstr("swelling 0.931"));
  EXPECT_THAT(near, testing::Not(HasSubstr("0.990")));
  step["rivals"][1]["score"] = -7309.8;
  EXPECT_THAT(choice_table(before, step, 1.0, {}, "photos"),
              HasSubstr("odds of more than a million to one"));
  step["chi_fit"] = 3.2;  // nobody is sure of an effect beside which much is left
  EXPECT_THAT(choice_table(before, step, 1.0, {}, "photos"),
              HasSubstr("alone it leaves 3.20 times the noise floor"));
}

/// One effect in another form is no choice between effects: what it is now, and what that takes.
TEST(Text, AnotherFormIsToldInItsOwnWords) {
  const auto before = nlohmann::json::parse(R"({"added": "swelling", "chi_fit": 6.0,
      "chi_validate": 8.0, "says": ["swelling: the body has swollen by 1 %"]})");
  const auto step = nlohmann::json::parse(R"({"added": "swelling", "dropped": ["swelling"],
      "chi_fit": 1.5, "chi_validate": 1.0,
      "says": ["swelling: it has swollen by 1 % in the middle, more to the left"]})");
  EXPECT_EQ(
      choice_table(before, step, 1.0, {}, "photos"),
      "\nwhy swelling, other parametrisation: it has swollen by 1 % in the middle, more to the "
      "left\n"
      "  (residual over noise floor: 1.50 fitted, 1.00 held out; before: 6.00 fitted, 8.00 held "
      "out)\n");
}

/// The bar is of what is over the floor, not of the floor.
TEST(Text, TheBarEndsAtTheFloor) {
  const auto timeline = nlohmann::json::parse(R"({"floor": {"chi": 1.0}, "steps": [
      {"name": "base", "chi_fit": 5.0}, {"name": "swelling", "chi_fit": 3.0},
      {"name": "swelling", "dropped": ["swelling"], "chi_fit": 1.0}]})");
  EXPECT_EQ(
      steps_table(timeline),
      "  step                             residual  held out  rms px  over noise floor\n"
      "  base                             5.000     -         0.000   5.00 ####################\n"
      "  swelling                         3.000     -         0.000   3.00 ##########..........\n"
      "  swelling, other parametrisation  1.000     -         0.000   1.00 ....................\n");
}

/// An effect that its figure alone would name says which guard keeps it from that.
TEST(Text, AnEffectAboveTheCriticalValueSaysWhyItIsNotNamed) {
  Diagnosis diagnosis;
  diagnosis.gate = 12.1;
  diagnosis.floor.chi = 1.2;  // a tenth of 0.44 may be a renderer's
  diagnosis.floor.per_px2 = 4.0;
  EffectScore score;
  score.effect = "gravity", score.evidence = 20.4, score.fall = 0.01;
  diagnosis.effects = {score};
  const auto why = [&] { return not_named_because(diagnosis.effects[0], diagnosis); };
  EXPECT_EQ(why(),
            "its log Bayes factor 20.4 is above the critical value 12.1, but that knows of noise "
            "alone: it would lower the squared residual by 0.01 (as 0.05 px of motion all over the "
            "surface), and the error of a renderer or a lens may be as much as 0.044 (as 0.1 px of "
            "motion all over the surface)");
  const std::string text = diagnosis_table(diagnosis, "photos");
  EXPECT_THAT(text, testing::ContainsRegex("gravity is not named: its log Bayes factor 20.4"));
  EXPECT_THAT(too_long(text), IsEmpty());
  diagnosis.effects[0].mesh_fall = 0.09;
  EXPECT_THAT(why(), HasSubstr("the mesh's own error may be as much as 0.09"));
  diagnosis.effects[0].evidence = 8.0;
  EXPECT_THAT(why(), HasSubstr("8.0 is below 12.1, the 95 % critical value over all effects"));
  diagnosis.gate = 2.0, diagnosis.effects[0].evidence = 4.0;
  EXPECT_THAT(why(), HasSubstr("is below 5, which is asked for in any case"));
  diagnosis.effects[0].evidence = 20.4, diagnosis.effects[0].fall = 1.0;
  EXPECT_EQ(why(), "");
}

}  // namespace
}  // namespace hookeye::test
