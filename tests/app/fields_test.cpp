// A capture of fields alone from outside: no photo, no camera.
#include <gmock/gmock.h>

#include "app/cli.h"

namespace hookeye::test {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// The cube under a pull on its top, seen from one side; `W` is what 1 mm of height gains.
class FieldCapture : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_cube("{z: 0.8}");
    std::string yaml = read(folder_ / "capture.yaml");
    yaml += "    measured:\n      - {force_on: top, value: [0, 0, 1.2], sigma: 0.05}\n";
    yaml += "      - {field: u.csv, sigma: 0.02}\n";
    write("capture.yaml", yaml);
    std::string table = "X,Y,Z,U,V,W\n";
    for (int y = 1; y < 10; ++y)
      for (int z = 1; z < 10; ++z)
        table += "0," + std::to_string(y) + "," + std::to_string(z) + ",0.1," +
                 std::to_string(0.01 * (5 - y)) + "," + std::to_string(0.08 * z) + "\n";
    write("u.csv", table + "0,nan,1,0,0,0\n");
  }
};

TEST_F(FieldCapture, CheckListsItAndAsksForItsUnit) {
  const Result said = hookeye("check capture.yaml");
  EXPECT_EQ(said.status, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("measured fields [mm]"));
  EXPECT_THAT(said.out, HasSubstr("field of 81 points"));
  EXPECT_THAT(said.err, HasSubstr("neither u.csv nor the capture tells the unit"));
  EXPECT_THAT(too_long(said.out), IsEmpty());
  const json document = json::parse(hookeye("check --json capture.yaml").out);
  const json& field = document.at("fields").at(0);
  EXPECT_EQ(field.at("points"), 81);
  EXPECT_EQ(field.at("dropped"), 1);
  EXPECT_EQ(field.at("components"), 3);
  EXPECT_NEAR(field.at("spacing").get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(field.at("correlation").get<double>(), 3.0, 1e-9);
}

/// Displacements as one program has them are another one's with the other sign.
TEST_F(FieldCapture, CheckSeesDisplacementsOfTheOtherSign) {
  const char* way = "move the other way than the first guess (cosine -";
  EXPECT_THAT(hookeye("check capture.yaml").err, Not(HasSubstr(way)));
  std::string turned = "X,Y,Z,U,V,W\n";
  for (int y = 1; y < 10; ++y)
    for (int z = 1; z < 10; ++z)
      turned += fmt::format("0,{},{},-0.1,{},{}\n", y, z, 0.01 * (y - 5), -0.08 * z);
  write("u.csv", turned);
  const Result said = hookeye("check capture.yaml");
  EXPECT_EQ(said.status, 0) << said.err;
  EXPECT_THAT(said.err, HasSubstr(way));
  EXPECT_THAT(said.err, HasSubstr("from the reference to the loaded body"));
}

TEST_F(FieldCapture, AFitIsComparedAndReported) {
  const Result fitted = hookeye("fit capture.yaml -o run");
  ASSERT_EQ(fitted.status, 0) << fitted.err;
  const Result compared = hookeye("compare run");
  EXPECT_EQ(compared.status, 0) << compared.err;
  EXPECT_THAT(compared.out, HasSubstr("u.csv"));
  EXPECT_THAT(compared.out, HasSubstr("force_on"));
  EXPECT_THAT(too_long(compared.out), IsEmpty());
  const json metrics = json::parse(read(folder_ / "run/steps/00-base/metrics.json"));
  ASSERT_EQ(metrics.at("fields").size(), 1u);
  EXPECT_EQ(metrics.at("fields").at(0).at("chi"), metrics.at("chi_fit"));
  EXPECT_EQ(metrics.at("measured").size(), 1u) << "a table of all points would be no help";
  EXPECT_THAT(read(folder_ / "run/steps/00-base/deformed/pull.vtu"), HasSubstr("field_residual"));
  const Result reported = hookeye("report run -o report.html");
  EXPECT_EQ(reported.status, 0) << reported.err;
  EXPECT_THAT(reported.err, Not(HasSubstr("residuals is not there")));
  EXPECT_TRUE(fs::exists(folder_ / "report.html"));
  EXPECT_EQ(hookeye("plan run").status, 2) << "there is no camera to look from";
  // A field that was measured anew is another capture.
  write("u.csv", "X,Y,Z,U,V,W\n0,5,5,0,0,0\n");
  EXPECT_NE(hookeye("compare run").err + hookeye("diagnose run").err, "");
}

/// A field at rest shows how its noise is along each axis.
TEST_F(FieldCapture, CheckTellsTheNoiseOfEachComponent) {
  write("capture.yaml", read(folder_ / "capture.yaml") +
                            "  rest:\n    supports: [{region: base, fix: [x, y, z]}]\n"
                            "    measured: [{field: rest.csv, sigma: 0.01, correlation: 0}]\n");
  std::string table = "X,Y,Z,U,V,W\n";
  unsigned random = 1;
  const auto noise = [&random](double size) {  // even within the size
    random = random * 1664525U + 1013904223U;
    return std::to_string(size * (random / 2147483648.0 - 1.0));
  };
  for (int y = 1; y < 20; ++y)
    for (int z = 1; z < 20; ++z)
      table += "0," + std::to_string(0.5 * y) + "," + std::to_string(0.5 * z) + "," + noise(0.06) +
               "," + noise(0.006) + "," + noise(0.006) + "\n";
  write("rest.csv", table);
  const Result said = hookeye("check capture.yaml --quick");
  ASSERT_EQ(said.status, 0) << said.err;
  EXPECT_THAT(said.err, HasSubstr("`sigma` is 0.01 for all: give one a component, `sigma: [0.03"));
  const json document = json::parse(hookeye("check --quick --json capture.yaml").out);
  const json& rest = document.at("fields").at(1);
  const double root3 = 1.7320508;
  EXPECT_NEAR(rest.at("rough_along").at(0).get<double>(), 0.06 / root3, 0.004);
  EXPECT_NEAR(rest.at("rough_along").at(1).get<double>(), 0.006 / root3, 0.0004);
  EXPECT_NEAR(rest.at("rough_along").at(2).get<double>(), 0.006 / root3, 0.0004);
  // Told so, nothing is left to say.
  std::string text = read(folder_ / "capture.yaml");
  text.replace(text.find("sigma: 0.01, corr"), 11, "sigma: [0.035, 0.0035, 0.0035]");
  write("capture.yaml", text);
  const Result told = hookeye("check capture.yaml --quick");
  EXPECT_THAT(told.err, Not(HasSubstr("give one a component")));
  EXPECT_THAT(told.out, testing::ContainsRegex("0[.]035 +0[.]034 +0[.]06"));
}

/// A sigma far below what the field itself shows, loaded and alone or measured twice.
TEST_F(FieldCapture, CheckSeesASigmaThatIsTooSmall) {
  unsigned random = 7;
  const auto uneven = [&random](double size) {  // even within the size
    random = random * 1664525U + 1013904223U;
    return size * (random / 2147483648.0 - 1.0);
  };
  // 0.03 deviates by 0.0173; `alike`: points in 2 x 2 as one.
  const auto write_field = [&](const std::string& name, bool alike) {
    std::string table = "X [mm],Y,Z,U,V,W\n";
    std::vector<double> last(19 * 3 + 3, 0.0);
    for (int y = 1; y < 20; ++y)
      for (int z = 1; z < 20; ++z) {
        table += fmt::format("0,{},{}", 0.5 * y, 0.5 * z);
        for (int c = 0; c < 3; ++c) {
          double& noise = last[static_cast<size_t>(alike ? 3 * ((z - 1) / 2) + c : c)];
          if (!alike || ((y - 1) % 2 == 0 && (z - 1) % 2 == 0)) noise = uneven(0.03);
          table += fmt::format(",{}", noise + (c == 2 ? 0.04 * z + 0.0008 * z * z : 0.01 * c * y));
        }
        table += "\n";
      }
    write(name, table);
  };
  const std::string yaml = read(folder_ / "capture.yaml");
  const auto said = [&](const std::string& entries) {
    std::string text = yaml;
    const std::string own = "      - {field: u.csv, sigma: 0.02}\n";
    text.replace(text.find(own), own.size(), entries);
    write("capture.yaml", text);
    const Result checked = hookeye("check capture.yaml --quick");
    EXPECT_EQ(checked.status, 0) << checked.err;
    return checked.err;
  };
  write_field("u.csv", false);
  const char *promises = "told too small it promises too much",
             *one = "      - {field: u.csv, sigma: ";
  EXPECT_THAT(said(std::string(one) + "0.002}\n"),
              testing::AllOf(testing::ContainsRegex("neighbouring points of the field scatter by "
                                                    "0[.]01[5-9], 0[.]01[5-9], 0[.]01[5-9] mm"),
                             HasSubstr("`sigma` is 0.002"), HasSubstr(promises)));
  EXPECT_THAT(said(std::string(one) + "[0.017, 0.002, 0.017]}\n"),
              testing::AllOf(HasSubstr("`sigma` is 0.017, 0.002, 0.017"), HasSubstr(promises)));
  for (const char* right : {"0.0173}\n", "0.1}\n"})
    EXPECT_THAT(said(one + std::string(right)), Not(HasSubstr(promises)));
  // What neighbours share shows between two of one load case.
  write_field("u.csv", true), write_field("again.csv", true);
  const std::string other = "      - {field: again.csv, sigma: ";
  EXPECT_THAT(said(std::string(one) + "0.005}\n" + other + "0.005}\n"),
              testing::AllOf(HasSubstr("beside again.csv, of the same points and load case, the "
                                       "field is noisy by 0.01"),
                             HasSubstr(promises)));
  EXPECT_THAT(said(std::string(one) + "0.0173}\n" + other + "0.0173}\n"), Not(HasSubstr(promises)));
}

/// Whatever is said of a capture without a photo has none in it.
TEST_F(FieldCapture, NothingIsSaidOfPhotos) {
  const std::string yaml = read(folder_ / "capture.yaml");
  write("capture.yaml",
        yaml + "  half:\n    use: validate\n" + yaml.substr(yaml.find("    supports:")));
  for (const char* command :
       {"fit capture.yaml -o run", "diagnose run", "explain run", "discover capture.yaml -o search",
        "compare search", "explain search", "add run strain_stiffening"}) {
    const Result said = hookeye(command);
    ASSERT_EQ(said.status, 0) << command << "\n" << said.err;
    std::istringstream lines(said.out + said.err);
    for (std::string line; std::getline(lines, line);) {
      // "no photo", which an effect wants that is not tested, is true.
      if (line.find("no photo") != std::string::npos) continue;
      EXPECT_THAT(line, Not(AnyOf(HasSubstr("photo"), HasSubstr("hookeye plan")))) << command;
    }
  }
}

/// The second half of the pull, by a program that took the first half as its reference.
TEST_F(FieldCapture, AFieldMayStartFromALoadCase) {
  std::string yaml = read(folder_ / "capture.yaml");
  const auto replace = [&](const std::string& from, const std::string& to) {
    ASSERT_NE(yaml.find(from), std::string::npos) << from << yaml;
    yaml.replace(yaml.find(from), from.size(), to);
  };
  const size_t begin = yaml.find("  pull:\n"), end = yaml.find("    measured:", begin);
  ASSERT_NE(end, std::string::npos);
  std::string half = yaml.substr(begin, end - begin);
  half.replace(half.find("pull"), 4, "half");
  half.replace(half.find("z: 0.8"), 6, "z: 0.4");
  replace("  pull:\n", half + "  pull:\n");
  replace("{field: u.csv, sigma: 0.02}", "{field: u.csv, sigma: 0.02, from: half}");
  write("capture.yaml", yaml);
  std::string table = "X [mm],Y [mm],Z [mm],U [mm],V [mm],W [mm]\n";
  for (int y = 1; y < 10; ++y)
    for (int z = 1; z < 10; ++z)
      table += "0.05," + std::to_string(y + 0.005 * (5 - y)) + "," + std::to_string(1.04 * z) +
               ",0.05," + std::to_string(0.005 * (5 - y)) + "," + std::to_string(0.04 * z) + "\n";
  write("u.csv", table);
  const Result checked = hookeye("check capture.yaml");
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("field of 81 points from half"));
  EXPECT_THAT(checked.out, HasSubstr("pull from half"));
  EXPECT_THAT(checked.err, testing::Not(HasSubstr("u.csv")));
  const Result fitted = hookeye("fit capture.yaml -o run");
  ASSERT_EQ(fitted.status, 0) << fitted.err;
  EXPECT_THAT(hookeye("compare run").out, HasSubstr("pull from half"));
  const json metrics = json::parse(read(folder_ / "run/steps/00-base/metrics.json"));
  const json& field = metrics.at("fields").at(0);
  EXPECT_EQ(field.at("from"), "half");
  EXPECT_LT(field.at("gap").get<double>(), 0.2);
  EXPECT_LT(field.at("rms").get<double>(), 0.1);
  EXPECT_THAT(read(folder_ / "run/steps/00-base/deformed/pull.vtu"), HasSubstr("field_residual"));
  EXPECT_EQ(hookeye("diagnose run").status, 0);
  const Result exported = hookeye("export run --to dic -o dic");
  ASSERT_EQ(exported.status, 0) << exported.err;
  EXPECT_THAT(read(folder_ / "dic/reporting.csv"), HasSubstr("reference,load case half"));
  const std::string written = read(folder_ / "dic/pull-u.csv");
  const std::string row = written.substr(written.find('\n') + 1);
  EXPECT_NEAR(std::stod(row), 0.05, 0.05) << "the places are those of `half`";
  write("capture.yaml", yaml.replace(yaml.find("from: half"), 10, "from: hall"));
  const Result unknown = hookeye("check capture.yaml");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("starts from `hall`, and there is no such example"));
}

TEST_F(FieldCapture, APointOffTheBodyEndsWithItsLine) {
  write("u.csv", "X [mm],Y,Z,U,V,W\n0,5,5,0,0,0\n-4,5,5,0,0,0\n");
  const Result said = hookeye("check capture.yaml");
  EXPECT_EQ(said.status, 2);
  EXPECT_THAT(said.err,
              HasSubstr("u.csv:3: the point (-4, 5, 5) lies 4 mm off the body's surface"));
}

}  // namespace
}  // namespace hookeye::test
