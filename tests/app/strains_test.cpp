// A capture of strains alone from outside: no photo, no camera, no displacement.
#include <gmock/gmock.h>

#include "app/cli.h"

namespace hookeye::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

/// The cube under a pull on its top, its strains on one side in per cent.
class StrainCapture : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_cube("{z: 0.8}");
    std::string yaml = read(folder_ / "capture.yaml");
    yaml += "    measured:\n      - {force_on: top, value: [0, 0, 1.2], sigma: 0.05}\n";
    yaml +=
        "      - {field: e.csv, strain: green, sigma: [0.02, 0.01, 0.01], gauge: 2, axes: [[0, 1, "
        "0], [0, 0, 1]]}\n";
    write("capture.yaml", yaml);
    write("e.csv", table("%"));
  }
  static std::string table(const std::string& unit) {
    std::string out =
        "X [mm],Y [mm],Z [mm],exx [" + unit + "],eyy [" + unit + "],exy [" + unit + "]\n";
    for (int y = 1; y < 10; ++y)
      for (int z = 1; z < 10; ++z)
        out += "0," + std::to_string(y) + "," + std::to_string(z) + "," +
               std::to_string(-1.0 - 0.1 * (z % 2)) + "," + std::to_string(8.0 + 0.1 * (y % 2)) +
               ",0\n";
    return out;
  }
};

TEST_F(StrainCapture, CheckListsItInMillistrain) {
  const Result said = hookeye("check capture.yaml");
  EXPECT_EQ(said.status, 0) << said.err;
  EXPECT_THAT(said.out,
              AllOf(HasSubstr("measured strains [millistrain; alike, gauge and gap in mm]"),
                    HasSubstr("field of green strains at 81"), HasSubstr("rms [millistrain]")));
  EXPECT_THAT(said.err, testing::Not(HasSubstr("e.csv"))) << "nothing is wrong with it";
  EXPECT_THAT(too_long(said.out), IsEmpty());
  const json document = json::parse(hookeye("check --json capture.yaml").out);
  const json& field = document.at("fields").at(0);
  EXPECT_EQ(field.at("holds"), "strains");
  EXPECT_EQ(field.at("strain"), "green");
  EXPECT_NEAR(field.at("largest").get<double>(), 0.081, 1e-9);
  EXPECT_EQ(field.at("sigmas").size(), 3u);
}

TEST_F(StrainCapture, PerCentForFractionsAreSeen) {
  write("e.csv", table("1"));
  EXPECT_THAT(hookeye("check capture.yaml").err, HasSubstr("the field's `strain_unit` (percent"));
}

TEST_F(StrainCapture, AFitIsComparedReportedAndExported) {
  const Result fitted = hookeye("fit capture.yaml -o run");
  ASSERT_EQ(fitted.status, 0) << fitted.err;
  const Result compared = hookeye("compare run");
  EXPECT_EQ(compared.status, 0) << compared.err;
  EXPECT_THAT(compared.out, HasSubstr("e.csv"));
  const json metrics = json::parse(read(folder_ / "run/steps/00-base/metrics.json"));
  EXPECT_EQ(metrics.at("fields").at(0).at("holds"), "strains");
  EXPECT_LT(metrics.at("fields").at(0).at("rms").get<double>(), 0.05);
  EXPECT_THAT(read(folder_ / "run/steps/00-base/deformed/pull.vtu"),
              AllOf(HasSubstr("strain_residual"), testing::Not(HasSubstr("field_residual"))));
  EXPECT_EQ(hookeye("report run -o report.html").status, 0);
  EXPECT_EQ(hookeye("diagnose run").status, 0);
  ASSERT_EQ(hookeye("export run --to dic -o dic").status, 0);
  const std::string written = read(folder_ / "dic/pull-e.csv");
  EXPECT_THAT(written, HasSubstr("exx_photo"));
}

TEST_F(StrainCapture, ADisplacementFileSaysWhatItHoldsBeside) {
  write("u.csv", "X [mm],Y [mm],Z [mm],U [mm],V [mm],W [mm],exx,eyy\n0,5,5,0.1,0,0.4,0,0\n");
  std::string yaml = read(folder_ / "capture.yaml");
  const size_t at = yaml.find("      - {field: e.csv");
  write("capture.yaml", yaml.substr(0, at) + "      - {field: u.csv, sigma: 0.02}\n");
  EXPECT_THAT(hookeye("check capture.yaml").out,
              HasSubstr("u.csv holds strains too (exx, eyy): an entry with `strain: green` would "
                        "read them"));
}

}  // namespace
}  // namespace hookeye::test
