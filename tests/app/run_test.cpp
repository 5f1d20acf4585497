// Commands on a run: what they say, what they write into run.json, what they make of a broken one.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "app/fitted_run.h"
#include "capture_io/image.h"

namespace hookeye::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

/// run/ with a base model and gravity added to it, as far as compare and report read it.
class WrittenRun : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_cube("{z: 1}");
    json timeline = {{"hookeye", 1},
                     {"capture", (folder_ / "capture.yaml").string()},
                     {"verdict", "explained"},
                     {"sentence", "missing: gravity"},
                     {"steps", json::array()}};
    for (const std::string name : {"base", "gravity"}) {
      write_step((name == "base" ? "00-" : "01-") + name);
      timeline["steps"].push_back(
          {{"name", name}, {"added", nullptr}, {"effects", json::array()}, {"chi_fit", 22.0}});
    }
    write("run/run.json", timeline.dump(2));
  }

  void write_step(const std::string& name) const {
    const std::string step = "run/steps/" + name + "/";
    for (const char* sub : {"compare", "residuals", "page"})
      fs::create_directories(folder_ / step / sub);
    write(step + "compare/pull_left.png", "a picture");
    const std::string longish = "an_example_with_a_long_name_indeed";
    json photos = json::array(), measured = json::array();
    for (const double chi : {22.0, 11.0, 0.5})
      photos.push_back({{"example", longish},
                        {"camera", "the_camera_on_the_left"},
                        {"use", "validate"},
                        {"chi", chi},
                        {"rms_px", 1.234},
                        {"only_noise", false}});
    measured.push_back({{"example", longish},
                        {"kind", "position_of"},
                        {"region", "a_region_with_a_long_name"},
                        {"measured", {-1.2345e-5, 12.345, -123.45}},
                        {"predicted", {-1.2345e-5, 12.345, -123.45}},
                        {"over_sigma", {-1.2345e-5, 12.345, -123.45}}});
    std::string sentence = "the photos leave open";
    for (int i = 0; i < 30; ++i) sentence += " a word";
    const json metrics = {{"chi_fit", 22.0},
                          {"chi_validate", 0.0},
                          {"rms_px_fit", 1.5},
                          {"rms_px_validate", 0.0},
                          {"converged", true},
                          {"floor", {{"chi", 1.1}, {"source", "rest photos"}}},
                          {"photos", photos},
                          {"chi_by_example", {{longish + longish + longish, 22.0}}},
                          {"chi_by_camera", {{"left", 11.0}}},
                          {"measured", measured},
                          {"undetermined", {sentence}}};
    write(step + "metrics.json", metrics.dump(1));
    write(step + "parameters.csv",
          "name,unit,long_name,value,low,high\nmu,MPa,\"modulus, shear\",0.05,0.04,0.06\n");
  }

  /// The document inside the report of run/, and what the report says is wrong with the run. Null
  /// where the program was built without Node.js.
  json report() const {
    const Result result = hookeye("report run -o page.html --json");
    if (result.status != 0) {
      EXPECT_THAT(result.err, HasSubstr("without its page"));
      return {};
    }
    const std::string page = read(folder_ / "page.html"), open = "id=\"document\">";
    const size_t begin = page.find(open) + open.size();
    json document = json::parse(page.substr(begin, page.find("</script>", begin) - begin));
    document["faults"] = json::parse(result.out).at("faults");
    return document;
  }
};

TEST_F(WrittenRun, CompareFitsAHundredColumns) {
  const Result result = hookeye("compare run");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(too_long(result.out), IsEmpty());
  EXPECT_THAT(result.out, HasSubstr("-1.234e-05"));
  EXPECT_THAT(result.out, HasSubstr("steps/01-gravity/compare\n"));
}

TEST_F(WrittenRun, CompareDrawsABarWithTheFloorForEveryPhoto) {
  const Result result = hookeye("compare run");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("#|#############"));  // chi 22, the floor at 1.1
  EXPECT_THAT(result.out, HasSubstr("#|######......."));  // 11
  EXPECT_THAT(result.out, HasSubstr(".|............."));  // 0.5: below it
}

TEST_F(WrittenRun, OfACaptureWithoutPhotosCompareTellsForcesAlone) {
  write("capture.yaml", read(folder_ / "capture.yaml") +
                            "    measured:\n"
                            "      - {force_on: top, value: [0, 0, 1.8], sigma: 0.01}\n");
  const Result fit = hookeye("fit . -o forces");
  ASSERT_EQ(fit.status, 0) << fit.err;
  const Result result = hookeye("compare forces");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("force_on"));
  for (const char* of_photos : {"pictures:", "camera", "by example"})
    EXPECT_THAT(result.out, Not(HasSubstr(of_photos)));
}

TEST_F(WrittenRun, CompareNamesTheChannelsOfAColourPhoto) {
  const fs::path file = folder_ / "run/steps/01-gravity/metrics.json";
  json metrics = json::parse(read(file));
  for (auto& photo : metrics["photos"]) photo["example"] = "pull", photo["camera"] = "front";
  std::ofstream(file) << metrics;
  EXPECT_THAT(hookeye("compare run").out, Not(HasSubstr("front r ")));
  for (int plane = 0; plane < 3; ++plane) metrics["photos"][plane]["plane"] = plane;
  std::ofstream(file) << metrics;
  const std::string out = hookeye("compare run").out;
  for (const char* channel : {"front r ", "front g ", "front b "})
    EXPECT_THAT(out, HasSubstr(channel));
}

TEST_F(WrittenRun, CompareSaysWhereAFileIsDamaged) {
  const fs::path file = folder_ / "run/steps/01-gravity/metrics.json";
  fs::resize_file(file, 40);
  const Result result = hookeye("compare run");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("metrics.json: the file is damaged (cut short at byte 40)"));
  EXPECT_THAT(result.err, Not(HasSubstr("json.exception")));
}

TEST_F(WrittenRun, TheReportOfARunWithoutItsTimelineTellsOfItsSteps) {
  const std::string whole = read(folder_ / "run/run.json");
  for (const bool gone : {true, false}) {
    if (gone)
      fs::remove(folder_ / "run/run.json");
    else
      write("run/run.json", whole.substr(0, 50));
    const json document = report();
    if (document.is_null()) GTEST_SKIP() << "built without the page";
    const json& timeline = document.at("timeline");
    EXPECT_FALSE(timeline.contains("sentence"));
    EXPECT_EQ(timeline.at("floor").at("chi"), 1.1);
    ASSERT_EQ(timeline.at("steps").size(), 2U);
    const json& step = timeline.at("steps").at(1);
    EXPECT_EQ(step.at("name"), "gravity");
    EXPECT_EQ(step.at("added"), "gravity");
    EXPECT_EQ(step.at("chi_fit"), 22.0);
    EXPECT_TRUE(step.at("chi_validate").is_null());
    EXPECT_EQ(step.at("parameters").at(0).at("long_name"), "modulus, shear");
    EXPECT_EQ(step.at("parameters").at(0).at("high"), 0.06);
    EXPECT_THAT(document.at("faults").get<std::vector<std::string>>(),
                Contains(StartsWith(gone ? "run.json is not there: steps"
                                         : "run.json is damaged (cut short at byte 50): steps")));
    EXPECT_EQ(fs::exists(folder_ / "run/run.json"), !gone) << "the report only reads";
  }
}

TEST_F(WrittenRun, DamagedFilesAreNamedInWords) {
  write("run/steps/00-base/page/body.json", "{\"nodes\": [1, 2");
  write("run/steps/00-base/diagnosis.json", "");
  write("run/steps/01-gravity/metrics.json", "{]");
  const json document = report();
  if (document.is_null()) GTEST_SKIP() << "built without the page";
  const auto faults = document.at("faults").get<std::vector<std::string>>();
  EXPECT_THAT(faults, Contains(StartsWith("field/00-base/body.json is damaged (cut short at byte "
                                          "15): ")));
  EXPECT_THAT(faults, Contains(StartsWith("00-base/diagnosis.json is damaged (cut short at byte "
                                          "0): ")));
  EXPECT_THAT(faults, Contains(StartsWith("01-gravity/metrics.json is damaged (not JSON from byte "
                                          "2 on): ")));
  EXPECT_THAT(faults, Not(Contains(HasSubstr("json.exception"))));
}

/// A verdict as discover writes it.
class JudgedRun : public FittedRun {
 protected:
  void judge() const {
    json changed = timeline();
    changed["verdict"] = "explained";
    changed["sentence"] = "missing: nothing";
    changed["missing"] = changed["tie"] = json::array();
    changed["fitted_to_all"] = {{"chi_fit", 1.0}};
    write("run/run.json", changed.dump(2));
  }
  void expect_unjudged() const {
    for (const char* key : {"verdict", "sentence", "missing", "tie", "fitted_to_all"})
      EXPECT_FALSE(timeline().contains(key)) << key;
  }
};

TEST_F(JudgedRun, AVerdictGoesWithTheNextStepAndComesBackWithDiscover) {
  judge();
  ASSERT_EQ(hookeye("add run gravity").status, 0);
  EXPECT_EQ(timeline().at("steps").size(), 2U);
  expect_unjudged();
  judge();
  ASSERT_EQ(hookeye("add run gravity --take-back").status, 0);
  EXPECT_EQ(timeline().at("steps").size(), 3U);
  expect_unjudged();
  const Result found = hookeye("discover capture -o run");  // goes on from the newest step
  ASSERT_EQ(found.status, 0) << found.err;
  EXPECT_THAT(too_long(found.out), IsEmpty());
  EXPECT_THAT(found.out, HasSubstr("/compare\n"));
  const json judged = timeline();
  // What was added is told beside what it was chosen from.
  const json& chosen = judged.at("steps").back();
  const std::string added = chosen.at("added");
  std::vector<std::string> raced;
  for (const json& one : chosen.at("raced")) raced.push_back(one.at("effect"));
  EXPECT_GT(raced.size(), 1U);
  EXPECT_THAT(raced, Contains(added));
  EXPECT_EQ(chosen.at("rivals").at(0).at("effect"), added);
  EXPECT_EQ(chosen.at("rivals")[0].at("chi_fit"), chosen.at("chi_fit"));
  EXPECT_EQ(chosen.at("made_in"), fs::canonical(folder_).string());
  EXPECT_THAT(found.out,
              HasSubstr("why " + added + ": normalised residual over the noise floor with "));
  for (const char* key : {"verdict", "sentence", "missing", "tie"})
    EXPECT_TRUE(judged.contains(key)) << key;
  // The same command on a finished run: no other step, the same verdict, and all steps are told.
  const Result again = hookeye("discover capture -o run");
  ASSERT_EQ(again.status, 0);
  EXPECT_THAT(again.out, HasSubstr("\n  base "));
  EXPECT_THAT(again.out,
              HasSubstr("why " + added + ": normalised residual over the noise floor with "));
  EXPECT_EQ(timeline().at("steps").size(), judged.at("steps").size());
  EXPECT_EQ(timeline().at("verdict"), judged.at("verdict"));
}

/// A diagnosis adds its own files to a finished step; all that the fit wrote keeps its bytes. The
/// intervals that reach for the mesh stand in diagnosis.json.
TEST_F(FittedRun, DiagnoseKeepsWhatTheFitWrote) {
  const auto files = [&] {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "run/steps/00-base"))
      if (entry.is_regular_file()) all[entry.path().string()] = read(entry.path());
    return all;
  };
  const auto before = files();
  ASSERT_EQ(hookeye("diagnose run").status, 0);
  auto after = files();
  for (const auto& [file, bytes] : before) EXPECT_TRUE(after[file] == bytes) << file;
  const fs::path step = folder_ / "run/steps/00-base";
  const json told = json::parse(read(step / "diagnosis.json"));
  EXPECT_EQ(told.at("parameters"), timeline().at("steps").at(0).at("parameters"));
  EXPECT_NE(told.at("energy"), json::parse(read(step / "metrics.json")).at("energy"));
}

TEST_F(FittedRun, DiagnoseFitsAHundredColumnsAndNamesItsPictures) {
  const Result result = hookeye("diagnose run");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(too_long(result.out), IsEmpty());
  EXPECT_THAT(result.out, HasSubstr("steps/00-base/compare\n"));
  EXPECT_THAT(result.out, HasSubstr("steps/00-base/removed\n"));
  // What is on disk is not diagnosed again.
  const Result added = hookeye("add run gravity");
  ASSERT_EQ(added.status, 0) << added.err;
  EXPECT_THAT(added.err, Not(HasSubstr("diagnosing the newest step")));
  // The new step is diagnosed at once: its intervals reach for the mesh, and what it lacks is
  // known.
  EXPECT_THAT(added.err, HasSubstr("diagnosing the new step"));
  EXPECT_TRUE(fs::exists(folder_ / "run/steps/01-gravity/diagnosis.json"));
  EXPECT_THAT(hookeye("add run swelling").err, Not(HasSubstr("diagnosing the newest step")));
}

/// What `add` must know of a step that nobody has diagnosed is kept with that step.
TEST_F(FittedRun, AddKeepsTheDiagnosisThatItMakes) {
  const Result added = hookeye("add run gravity");
  ASSERT_EQ(added.status, 0) << added.err;
  EXPECT_THAT(added.err, HasSubstr("diagnosing the newest step"));
  EXPECT_TRUE(fs::exists(folder_ / "run/steps/00-base/diagnosis.json"));
  EXPECT_FALSE(timeline().at("steps").at(0).at("diagnosis").empty());
  const Result back = hookeye("add run gravity --take-back");
  ASSERT_EQ(back.status, 0) << back.err;
  EXPECT_THAT(back.out, HasSubstr("times as large on the fitted photos"));
  EXPECT_THAT(back.err, Not(HasSubstr("take it back")));
}

/// For every photo one picture and its residual: photo, model, residual and arrows side by side.
TEST_F(FittedRun, CompareHasAPictureOfEveryPhoto) {
  const fs::path step = folder_ / "run/steps/00-base";
  const Encoding as_stored{Encoding::Kind::linear, 1.0};
  for (const std::string photo : {"rest-cam0", "pull-cam0", "push-cam0"}) {
    const Image drawn = read_image(step / "compare" / (photo + ".png"), as_stored);
    EXPECT_EQ(drawn.channels, 3);
    EXPECT_GE(drawn.width, 2 * 120);
    EXPECT_GE(drawn.height, 2 * 120);
    const Image residual = read_image_with_holes(step / "residuals" / (photo + ".exr"));
    const Image coloured = read_image(step / "residuals" / (photo + ".png"), as_stored);
    ASSERT_EQ(residual.pixels(), coloured.pixels());
    // Where the model is too bright the colour is red, where it is too dark blue; on one scale.
    int red = 0, blue = 0, wrong = 0;
    for (size_t i = 0; i < residual.pixels(); ++i) {
      const float r = residual.values[i], *colour = &coloured.values[i * coloured.channels];
      if (!(std::abs(r) > 4.0f)) continue;
      (r > 0.0f ? red : blue) += 1;
      wrong += (colour[0] > colour[2]) != (r > 0.0f);
    }
    EXPECT_GT(red, 10) << photo;
    EXPECT_GT(blue, 10) << photo;
    EXPECT_EQ(wrong, 0) << photo;
  }
  const Result said = hookeye("compare run");
  ASSERT_EQ(said.status, 0) << said.err;
  for (const char* what : {"by example", "by camera", "own floor", "by region", "what is left"})
    EXPECT_THAT(said.out, HasSubstr(what));
}

/// Arrays by name in the file's header, with finite ranges: ParaView shows nothing of NaN.
TEST_F(FittedRun, DeformedFilesHaveWhatParaViewShows) {
  for (const std::string example : {"rest", "pull", "push"}) {
    const std::string vtu = read(folder_ / "run/steps/00-base/deformed" / (example + ".vtu"));
    for (const std::string name : {"displacement", "residual", "residual_pixels", "reaction",
                                   "cauchy_stress", "green_strain", "von_mises", "J"}) {
      const size_t at = vtu.find("Name=\"" + name + "\"");
      ASSERT_NE(at, std::string::npos) << example << ": " << name;
      const std::string array = vtu.substr(at, vtu.find(">", at) - at);
      EXPECT_THAT(array, Not(HasSubstr("nan"))) << example;
      const std::string key = "RangeMax=\"";
      const double most = std::stod(array.substr(array.find(key) + key.size()));
      EXPECT_TRUE(std::isfinite(most)) << array;
      if (example != "rest") {
        EXPECT_GT(most, 0.0) << array;
      }
      // The one camera sees neither the back nor the inside.
      if (name.starts_with("residual")) {
        EXPECT_THAT(array, HasSubstr("RangeMin=\"0\""));
      }
    }
  }
}

TEST_F(FittedRun, OnlyWhatStandsIsTakenBack) {
  const Result none = hookeye("add run gravity --take-back");
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("it has none"));
  ASSERT_EQ(hookeye("add run gravity").status, 0);
  const Result other = hookeye("add run swelling --take-back");
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("it has gravity: take back one of these"));
  const Result again = hookeye("add run gravity");
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.err, HasSubstr("the newest step has this effect already"));
}

/// A model that lacks something leaves some of it in the rest photos: that is no higher floor.
TEST_F(FittedRun, TheFloorIsTheLowestThatAnyStepHasShown) {
  ASSERT_EQ(hookeye("diagnose run").status, 0);
  const double base = timeline().at("floor").at("chi");
  ASSERT_EQ(hookeye("add run gravity").status, 0);
  ASSERT_EQ(hookeye("diagnose run").status, 0);
  const double lowest = timeline().at("floor").at("chi");
  EXPECT_LT(lowest, base);
  ASSERT_EQ(hookeye("add run gravity --take-back").status, 0);
  ASSERT_EQ(hookeye("diagnose run").status, 0);
  EXPECT_EQ(timeline().at("floor").at("chi"), lowest);
}

}  // namespace
}  // namespace hookeye::test
