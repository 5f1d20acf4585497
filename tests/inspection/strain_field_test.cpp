// Fields of strains that are read otherwise than they are: by their own displacements, and by the
// first guess.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "estimation/field_block.h"
#include "inspection/inspected_capture.h"

namespace hookeye::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class StrainReadings : public testing::Test {
 protected:
  void write(const FieldBlock& block) const { block.write(folder_.path()); }
  std::string text(const std::string& file) const {
    std::ostringstream out;
    out << std::ifstream(folder_.path() / file).rdbuf();
    return out.str();
  }
  void replace(const std::string& file, const std::string& from, const std::string& to) const {
    std::string all = text(file);
    const size_t at = all.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    for (size_t found; (found = all.find(from)) != std::string::npos;)
      all.replace(found, from.size(), to);
    std::ofstream(folder_.path() / file) << all;
  }
  /// Every row of a table by `f`.
  void change(const std::string& file, const std::function<void(std::vector<double>&)>& f) const {
    std::istringstream lines(text(file));
    std::string line, out;
    std::getline(lines, line);
    out = line + "\n";
    while (std::getline(lines, line)) {
      std::istringstream cells(line);
      std::vector<double> row;
      for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
      f(row);
      std::string joint;
      for (const double one : row) out += joint + fmt::format("{}", one), joint = ",";
      out += "\n";
    }
    std::ofstream(folder_.path() / file) << out;
  }
  std::string of_strains() const {
    const auto scene = load_scene(read_capture(folder_.path()));
    std::string out;
    for (const CaptureWarning& warning : inspect(*scene, {}).warnings)
      if (warning.question == "strain_fields" || warning.question == "magnitudes" ||
          warning.question == "exchanges")
        out += warning.text() + "\n";
    return out;
  }
  void exchange(const std::string& one, const std::string& other) const {
    const std::string kept = text(one);
    const std::string file = (folder_.path() / one).string();
    std::ofstream(file) << text(other);
    std::ofstream(folder_.path() / other) << kept;
  }
  const TemporaryFolder folder_;
};

/// Exact strains of a known motion of the front's points, beside their displacements, by `measure`.
void with_displacements(const std::filesystem::path& file, const std::string& measure) {
  std::string out = "X,Y,Z,U,V,W,exx,eyy,exy\n";
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 19; ++j) {
      const double x = -9.0 + 2 * i, z = 2.0 + 2 * j;
      // x' = a x + b z, z' = c z: A = ((a, 0), (b, c)) by columns
      const double a = 0.95, b = 0.06, c = 1.15;
      const double Cxx = a * a, Czz = b * b + c * c, Cxz = a * b;
      Eigen::Vector3d e(0.5 * (Cxx - 1), 0.5 * (Czz - 1), 0.5 * Cxz);
      if (measure == "engineering")
        e = {a - 1, std::sqrt(Czz) - 1, 0.5 * std::asin(Cxz / std::sqrt(Cxx * Czz))};
      out += fmt::format("{},-8,{},{},0,{},{},{},{}\n", x, z, (a - 1) * x + b * z, (c - 1) * z,
                         e[0], e[1], e[2]);
    }
  std::ofstream(file) << out;
}

TEST_F(StrainReadings, DisplacementsInTheFileTellMeasureUnitAndShear) {
  write({.sigma = 1e-4, .strain = "green"});
  const auto pull = folder_.path() / "pull_front.csv";
  with_displacements(pull, "green");
  EXPECT_THAT(of_strains(), IsEmpty());
  with_displacements(pull, "engineering");
  EXPECT_THAT(of_strains(), AllOf(HasSubstr("the strains of"),
                                  HasSubstr("pull_front.csv agree with the "
                                            "displacements beside them where they "
                                            "are engineering strains"),
                                  HasSubstr("`strain: engineering`")));
  with_displacements(pull, "green");
  change("pull_front.csv", [](auto& row) { row[8] *= 2; });
  EXPECT_THAT(of_strains(), HasSubstr("where its shear is gamma = 2 exy"));
  with_displacements(pull, "green");
  change("pull_front.csv", [](auto& row) { row[8] *= -1; });
  EXPECT_THAT(of_strains(), HasSubstr("where exy has the other sign"));
  with_displacements(pull, "green");
  change("pull_front.csv", [](auto& row) { std::swap(row[6], row[7]); });
  EXPECT_THAT(of_strains(), HasSubstr("where exx and eyy are in each other's places"));
  with_displacements(pull, "green");
  change("pull_front.csv", [](auto& row) { row[6] *= 100, row[7] *= 100, row[8] *= 100; });
  EXPECT_THAT(of_strains(), HasSubstr("`strain_unit: percent`"));
}

TEST_F(StrainReadings, WithoutDisplacementsTheFirstGuessTells) {
  write({.mu = 0.06, .gravity = {0, 0, -9810}, .sigma = 1e-3, .strain = "hencky"});
  EXPECT_THAT(of_strains(), IsEmpty()) << "a hidden weight and a modulus off are no slips";
  change("pull_front.csv", [](auto& row) { std::swap(row[3], row[4]); });
  EXPECT_THAT(of_strains(),
              AllOf(HasSubstr("pull_front.csv agree with the first guess where exx and eyy are in "
                              "each other's places"),
                    Not(HasSubstr("bend"))));
  change("pull_front.csv", [](auto& row) { std::swap(row[3], row[4]); });
  change("bend_front.csv", [](auto& row) { row[5] *= -1; });
  EXPECT_THAT(of_strains(), HasSubstr("bend_front.csv agree with the first guess where exy has the "
                                      "other sign"));
  change("bend_front.csv", [](auto& row) { row[5] *= -2; });
  EXPECT_THAT(of_strains(), HasSubstr("where its shear is gamma = 2 exy"));
  change("bend_front.csv", [](auto& row) { row[5] *= 0.5; });
  EXPECT_THAT(of_strains(), IsEmpty());
  change("pull_front.csv", [](auto& row) { row[3] *= 100, row[4] *= 100, row[5] *= 100; });
  EXPECT_THAT(of_strains(), AllOf(HasSubstr("pull_front.csv are"), HasSubstr("`strain_unit`")));
}

TEST_F(StrainReadings, FieldsInEachOthersPlacesAreNamedWithTheirFiles) {
  for (const char* measure : {"green", "hencky"}) {
    write({.mu = 0.06, .gravity = {0, 0, -9810}, .sigma = 1e-3, .strain = measure});
    EXPECT_THAT(of_strains(), IsEmpty());
    // The push buckles the block: to first order it has another strain.
    const std::string all = text("capture.yaml");
    std::ofstream(folder_.path() / "capture.yaml") << all.substr(0, all.find("  push:"));
    exchange("pull_front.csv", "bend_front.csv");
    EXPECT_THAT(of_strains(),
                AllOf(HasSubstr("pull_front.csv shows the strain of example `bend`, and"),
                      HasSubstr("bend_front.csv shows the strain of example `pull`: of the squares "
                                "of their strains"),
                      HasSubstr("stand in one another's places"), Not(HasSubstr("flank"))));
  }
}

/// A field that starts from a load case is held against the difference of both guesses.
TEST_F(StrainReadings, OneThatStartsFromALoadCaseIsReadFromThere) {
  write({.mu = 0.06, .sigma = 1e-3, .from_pull = true, .strain = "green"});
  EXPECT_THAT(of_strains(), IsEmpty());
  change("bend_front.csv", [](auto& row) { std::swap(row[3], row[4]); });
  EXPECT_THAT(of_strains(), HasSubstr("bend_front.csv agree with the first guess where exx and eyy "
                                      "are in each other's places"));
}

}  // namespace
}  // namespace hookeye::test
