// The program from outside: exit status, standard output, standard error.
#include "app/cli.h"

#include <gmock/gmock.h>

#include <cmath>

namespace hookeye::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

TEST_F(Cli, HelpListsTheCommandsAndFitsAHundredColumns) {
  const Result help = hookeye("--help");
  EXPECT_EQ(help.status, 0);
  EXPECT_EQ(help.err, "");
  for (const std::string command : {"check", "mesh", "simulate"}) {
    EXPECT_THAT(help.out, HasSubstr("  " + command));
    const Result one = hookeye(command + " --help");
    EXPECT_EQ(one.status, 0);
    EXPECT_THAT(one.out, HasSubstr("--json"));
  }
  // every command there is, those added later too
  std::string pages = help.out, line;
  std::istringstream lines(help.out.substr(help.out.find("Subcommands:")));
  for (std::getline(lines, line); std::getline(lines, line) && line.starts_with("  ");)
    pages += hookeye(line.substr(2, line.find(' ', 2) - 2) + " --help").out;
  std::istringstream all(pages);
  while (std::getline(all, line)) EXPECT_LE(line.size(), 100U) << line;
}

TEST_F(Cli, UsageErrorsAreBadInput) {
  EXPECT_EQ(hookeye("").status, 2);
  const Result command = hookeye("simulat x");
  EXPECT_EQ(command.status, 2);
  EXPECT_EQ(command.out, "");
  EXPECT_THAT(command.err, HasSubstr("did you mean simulate"));
  const Result option = hookeye("simulate x -o y --jsn");
  EXPECT_EQ(option.status, 2);
  EXPECT_THAT(option.err, HasSubstr("did you mean --json"));
  EXPECT_EQ(hookeye("simulate").status, 2);
  EXPECT_EQ(hookeye("mesh cube.obj -o b.vtu --edge -1").status, 2);
  const Result without = hookeye("discover . -o run --without gravty");
  EXPECT_EQ(without.status, 2);
  EXPECT_THAT(without.err, HasSubstr("did you mean 'gravity'"));
  const Result asked = hookeye("check --json --frobnicate");
  EXPECT_EQ(asked.status, 2);
  EXPECT_EQ(json::parse(asked.out).at("exit"), 2);
}

TEST_F(Cli, CommonOptionsMayStandBeforeTheCommand) {
  const Result before = hookeye("--json --threads 1 effects"), behind = hookeye("effects --json");
  EXPECT_EQ(before.status, 0) << before.err;
  EXPECT_EQ(before.out, behind.out);
  EXPECT_THAT(hookeye("--threads 0 effects").err, HasSubstr("a whole number from 1 is expected"));
}

TEST_F(Cli, NumbersOutOfRangeAreToldInWords) {
  for (const std::string number : {"0", "-3", "two", "1.5", "99999999999"}) {
    const Result result = hookeye("check . --threads " + number);
    EXPECT_EQ(result.status, 2) << number;
    EXPECT_EQ(result.err, "hookeye check: --threads: a whole number from 1 is expected, not " +
                              number + "\n  hookeye check --help tells what is right\n");
  }
  for (const std::string size : {"0", "4X", "much", "1M"})
    EXPECT_THAT(hookeye("check . --memory " + size).err,
                HasSubstr("--memory: a size from 200M is expected, as 4G or 1.5GB, not " + size));
  EXPECT_THAT(hookeye("plan run --most 0").err, HasSubstr("a whole number from 1 is expected"));
  for (const std::string number : {"0", "-1", "nan", "inf"})
    EXPECT_THAT(hookeye("mesh cube.obj -o b.vtu --edge " + number).err,
                HasSubstr("--edge: a number above zero is expected, not " + number));
}

TEST_F(Cli, MissingFilesAreBadInput) {
  for (const std::string arguments : {"check nowhere", "mesh nothing.obj -o body.vtu",
                                      "simulate nowhere -o out", "plan nowhere"}) {
    const Result result = hookeye(arguments);
    EXPECT_EQ(result.status, 2) << arguments << ": " << result.err;
    EXPECT_EQ(result.out, "") << arguments;
    EXPECT_THAT(result.err, HasSubstr("no")) << arguments;
  }
}

TEST_F(Cli, AnUnknownKeyIsNamedWithItsPlace) {
  write_cube("{z: 1}");
  const std::string text = read(folder_ / "capture.yaml");
  write("capture.yaml", text + "exampels: {}\n");
  const Result result = hookeye("check .");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, ContainsRegex("capture\\.yaml:[0-9]+:1: "));
  EXPECT_THAT(result.err, HasSubstr("examples"));
  const Result as_json = hookeye("check . --json");
  EXPECT_EQ(as_json.status, 2);
  const json document = json::parse(as_json.out);
  EXPECT_EQ(document.at("error").at("kind"), "bad input");
  EXPECT_EQ(document.at("error").at("line"), 1 + std::count(text.begin(), text.end(), '\n'));
}

TEST_F(Cli, AnUnknownLawIsNamedWithItsPlace) {
  write_cube("{z: 1}", "neo-hokean");
  const Result result = hookeye("check .");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, ContainsRegex("capture\\.yaml:8:"));
  EXPECT_THAT(result.err, HasSubstr("neo-hookean"));
}

TEST_F(Cli, AMaterialThatCannotBeIsNamedWithItsPlace) {
  write_cube("{z: 1}");
  const std::string text = read(folder_ / "capture.yaml");
  const size_t begin = text.find("  material:"), end = text.find('\n', begin);
  const int line = 1 + static_cast<int>(std::count(text.begin(), text.begin() + begin, '\n'));
  const std::string rubber =
      "I1bar: {at: [0], stiffness: [0.05]}, J: {at: [0], stiffness: [0.5]}, ";
  struct Case {
    std::string material, value, wrong;  // the fault is told at the value
  };
  const std::vector<Case> cases = {
      {"law: additive, " + rubber + "E11: {at: [0, 0.2, 0.1], stiffness: [1, 1, 1]}",
       "[0, 0.2, 0.1]", "out of order: 0.1 after 0.2"},
      {"law: additive, " + rubber + "E11: {at: [0, 0.2, 0.2], stiffness: [1, 1, 1]}",
       "[0, 0.2, 0.2]", "0.2 of `E11.at` stands twice"},
      {"law: additive, " + rubber + "E22: {at: [0, 0.3], stiffness: [0.1, -0.7]}", "[0.1, -0.7]",
       "not convex at E22 = 0.3"},
      {"law: additive, " + rubber + "frame: [[1, 0, 0], [0.1, 1, 0], [0, 0, 1]]", "[[1, 0, 0]",
       "not orthonormal"},
      {"law: holzapfel, mu: 0.05, k1: 0.1, k2: 1, angles: [30], kappa: 0.5, dispersion: 0.35",
       "0.35", "`dispersion` is 0.35"},
      {"law: ogden, mu: [0.05, 0.01], alpha: [2], kappa: 0.5", "[2]", "2 moduli"}};
  for (const Case& one : cases) {
    const std::string told = "  material: {" + one.material + "}";
    write("capture.yaml", text.substr(0, begin) + told + text.substr(end));
    const Result result = hookeye("check .");
    EXPECT_EQ(result.status, 2) << one.material;
    EXPECT_THAT(result.err, HasSubstr("capture.yaml:" + std::to_string(line) + ":" +
                                      std::to_string(1 + told.find(one.value)) + ": "))
        << one.material;
    EXPECT_THAT(result.err, HasSubstr(one.wrong));
  }
}

TEST_F(Cli, CheckSaysWhatItUnderstood) {
  write_cube("{z: 1}");
  const Result lines = hookeye("check .");
  EXPECT_EQ(lines.status, 0) << lines.err;
  EXPECT_THAT(lines.out, HasSubstr("stress MPa"));
  EXPECT_THAT(lines.err, HasSubstr("only ratios of stiffness"));  // no force is told
  EXPECT_THAT(lines.err, HasSubstr("held out"));
  const Result result = hookeye("check capture.yaml --json");
  EXPECT_EQ(result.status, 0) << result.err;
  const json document = json::parse(result.out);
  EXPECT_NEAR(document.at("body").at("volume").get<double>(), 1000.0, 1e-6);
  ASSERT_EQ(document.at("regions").size(), 2U);
  for (const auto& region : document.at("regions"))
    EXPECT_NEAR(region.at("area").get<double>(), 100.0, 1e-6);
  EXPECT_EQ(document.at("examples").at(0).at("name"), "pull");
  EXPECT_EQ(document.at("examples").at(0).at("free_rigid_motions"), json::array());
  EXPECT_EQ(document.at("parameters").at(0).at("name"), "mu");
}

TEST_F(Cli, CheckNamesFreeRigidMotions) {
  write_cube("{z: 1}");
  std::string text = read(folder_ / "capture.yaml");
  text.replace(text.find("fix: [x, y, z]"), 14, "fix: [z]");
  write("capture.yaml", text);
  const Result result = hookeye("check . --json");
  EXPECT_EQ(result.status, 0) << result.err;
  // sliding along x, along y, turning about z
  EXPECT_EQ(json::parse(result.out).at("examples").at(0).at("free_rigid_motions").size(), 3U);
  EXPECT_THAT(result.err, HasSubstr("leaves the body free"));
}

TEST_F(Cli, MeshFillsASurfaceThatSimulateCanUse) {
  write_cube("{x: 0, y: 0, z: 1}");
  const Result result = hookeye("mesh cube.obj -o made/body.vtu --edge 4 --order 2 --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const json quality = json::parse(result.out).at("quality");
  EXPECT_NEAR(quality.at("volume").get<double>(), 1000.0, 1e-6);
  EXPECT_EQ(quality.at("order"), 2);
  EXPECT_GT(quality.at("min_dihedral_deg").get<double>(), 5.0);
  EXPECT_EQ(json::parse(result.out).at("asked").at("min_dihedral_deg"), 12.0);
  ASSERT_TRUE(fs::exists(folder_ / "made/body.vtu"));

  std::string text = read(folder_ / "capture.yaml");
  const std::string body = "surface: cube.obj\n  mesh: {edge: 6, order: 1}";
  text.replace(text.find(body), body.size(), "volume: made/body.vtu");
  write("capture.yaml", text);
  const Result simulated = hookeye("simulate . -o out --json");
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  EXPECT_EQ(json::parse(simulated.out).at("unknowns"), quality.at("unknowns"));

  EXPECT_EQ(hookeye("mesh cube.obj -o body.txt").status, 2);
}

TEST_F(Cli, MeshRepairsSaysWhatItDidAndWritesSurfaceOrBody) {
  write_cube("{z: 1}");
  if (!fs::exists(fs::path(HOOKEYE_PROGRAM).parent_path().parent_path() / "libexec/hookeye/repair"))
    GTEST_SKIP() << "SKIPPED: this build has no CGAL (apt-get install libcgal-dev)";
  std::string text = read(folder_ / "cube.obj");
  text.replace(text.find("f 3 4 8\n"), 8, "");           // a hole
  text.replace(text.find("f 1 2 6\n"), 8, "f 1 6 2\n");  // and one turned
  write("broken.obj", text);
  EXPECT_EQ(hookeye("mesh broken.obj -o body.vtu").status, 2);
  EXPECT_FALSE(fs::exists(folder_ / "body.vtu"));
  const Result surface = hookeye("mesh broken.obj --repair --edge 4 -o made/mended.obj");
  ASSERT_EQ(surface.status, 0) << surface.err;
  const std::string said = surface.out;
  const size_t turned = said.find("turned 1 triangles that faced against their neighbours"),
               filled = said.find("filled 1 holes, the longest 34.1 around, at ("),
               remeshed = said.find("remeshed to an edge of 4: ");
  EXPECT_LT(turned, filled) << said;
  EXPECT_LT(filled, remeshed) << said;
  EXPECT_LT(remeshed, said.find("written to made/mended.obj")) << said;
  EXPECT_THAT(said, HasSubstr("volume 1000 now; before, it enclosed none"));
  EXPECT_THAT(said, HasSubstr("area 550 -> 600 (+9.1 %)"));
  EXPECT_EQ(hookeye("mesh made/mended.obj -o body.vtu").status, 0);
  const Result body = hookeye("mesh broken.obj --repair -o again.vtu --json");
  ASSERT_EQ(body.status, 0) << body.err;
  EXPECT_NEAR(json::parse(body.out).at("quality").at("volume").get<double>(), 1000.0, 1e-6);
  EXPECT_EQ(json::parse(body.out).at("said").size(), 2U);
  EXPECT_NEAR(json::parse(body.out).at("area_before").get<double>(), 550.0, 1e-6);
  EXPECT_NEAR(json::parse(body.out).at("area").get<double>(), 600.0, 1e-6);

  EXPECT_THAT(hookeye("mesh broken.obj -o mended.obj").err, HasSubstr("a body is written as .vtu"));
  EXPECT_EQ(hookeye("mesh broken.obj --tolerance 1 -o a.vtu").status, 2) << "without --repair";
  write("flake.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Result flake = hookeye("mesh flake.obj --repair -o a.obj");
  EXPECT_EQ(flake.status, 2);
  EXPECT_THAT(flake.err, HasSubstr("could not be mended: only 0 % of the surface"));
  EXPECT_FALSE(fs::exists(folder_ / "a.obj"));
}

TEST_F(Cli, MeshTellsTheQualityAskedAndReached) {
  write_cube("{z: 1}");
  const auto mesh = [&](const std::string& asked) {
    return hookeye("mesh cube.obj -o body.vtu --edge 3 " + asked);
  };
  const Result strict = mesh("--min-angle 15 --radius-edge 1.2");
  ASSERT_EQ(strict.status, 0) << strict.err;
  EXPECT_THAT(strict.out, HasSubstr("the mesher was asked for angles of 15 degrees and more"));
  EXPECT_THAT(mesh("--min-angle 3").out, Not(HasSubstr("was asked for")));
  EXPECT_THAT(strict.out, Not(HasSubstr("flat tetrahedra")));
  // TetGen would not come to an end.
  EXPECT_EQ(mesh("--min-angle 30").status, 2);
}

/// First Piola-Kirchhoff stress of the neo-Hookean law in uniaxial stress at stretch l: the sides a
/// are where dW/da = 0, found by bisection. W(l, a) as in the capture's laws.
double uniaxial_stress(double mu, double kappa, double l) {
  const auto W = [&](double stretch, double a) {
    const double J = stretch * a * a;
    return mu / 2 * (std::pow(J, -2.0 / 3) * (stretch * stretch + 2 * a * a) - 3) +
           kappa / 2 * (J - 1) * (J - 1);
  };
  const double h = 1e-6;
  double low = 0.5, high = 1.5;
  while (high - low > 1e-14) {
    const double a = (low + high) / 2;
    (W(l, a + h) > W(l, a - h) ? high : low) = a;
  }
  // dW/da = 0, so an error of a enters squared
  return (W(l + h, low) - W(l - h, low)) / (2 * h);
}

TEST_F(Cli, SimulateWritesEveryExampleAndBalancesTheSupports) {
  write_cube("{z: 1}");
  // Free to contract: the state is uniform, so that any mesh gives the closed form.
  std::string text = read(folder_ / "capture.yaml");
  text.replace(text.find("fix: [x, y, z]"), 14, "fix: [z]");
  text.replace(text.find("examples:"), 9,
               "  left: {box: [[-0.1, -1, -1], [0.1, 11, 11]]}\n"
               "  front: {box: [[-1, -0.1, -1], [11, 0.1, 11]]}\nexamples:");
  text += "      - {region: left, fix: [x]}\n      - {region: front, fix: [y]}\n";
  write("capture.yaml", text);
  const Result result = hookeye("simulate . -o out --json");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_TRUE(fs::exists(folder_ / "out/deformed/pull.vtu"));
  const json example = json::parse(result.out).at("examples").at(0);
  const double base = example.at("supports").at(0).at("force").at(2);
  const double top = example.at("supports").at(1).at("force").at(2);
  EXPECT_NEAR(top, 100.0 * uniaxial_stress(0.05, 0.5, 1.1), 1e-7);
  EXPECT_NEAR(top + base, 0.0, 1e-7);
  const Result lines = hookeye("simulate . -o again");
  EXPECT_EQ(lines.status, 0);
  EXPECT_THAT(lines.out, HasSubstr("pull"));
  EXPECT_EQ(read(folder_ / "out/deformed/pull.vtu"), read(folder_ / "again/deformed/pull.vtu"));
}

TEST_F(Cli, NoEquilibriumIsExitThreeWithExampleAndLoad) {
  write_cube("{x: 0, y: 0, z: -20}");  // the top would have to pass through the base
  const Result result = hookeye("simulate . -o out --json");
  EXPECT_EQ(result.status, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr("pull"));
  const json error = json::parse(result.out).at("error");
  EXPECT_EQ(error.at("example"), "pull");
  EXPECT_GT(error.at("load_fraction").get<double>(), 0.05);
  EXPECT_LT(error.at("load_fraction").get<double>(), 0.5);
  EXPECT_FALSE(fs::exists(folder_ / "out/deformed/pull.vtu"));
}

}  // namespace
}  // namespace hookeye::test
