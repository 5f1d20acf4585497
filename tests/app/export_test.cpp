// hookeye export from outside: folders, warnings, exit status.
#include <cmath>
#include <sstream>

#include "app/fitted_run.h"

namespace hookeye::test {
namespace {

class Export : public FittedRun {};

TEST_F(Export, WritesAFolderForEachProgram) {
  for (const char* to : {"abaqus", "calculix", "febio", "json", "polyfem", "sofa"}) {
    const std::string name = to;
    const Result result = hookeye("export run --to " + name + " -o " + name);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(fs::exists(folder_ / name / "README.txt"));
    EXPECT_NE(read(folder_ / name / "README.txt").find("mu = "), std::string::npos);
    EXPECT_TRUE(too_long(result.out).empty());
  }
  EXPECT_TRUE(fs::exists(folder_ / "calculix/mesh.inp"));
  EXPECT_TRUE(fs::exists(folder_ / "calculix/pull.inp"));
  EXPECT_TRUE(fs::exists(folder_ / "calculix/pull.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "calculix/rest.inp"));  // nothing acts on the body
  // What a program lacks is a warning.
  const Result sofa = hookeye("export run --to sofa -o again --json");
  EXPECT_EQ(sofa.status, 0);
  const json document = json::parse(sofa.out);
  EXPECT_FALSE(document["lacks"].empty());
  EXPECT_EQ(document["warnings"].size(), document["lacks"].size());
}

TEST_F(Export, TakesAnEarlierStep) {
  ASSERT_EQ(hookeye("add run gravity").status, 0);
  ASSERT_EQ(hookeye("export run --to calculix -o newest").status, 0);
  ASSERT_EQ(hookeye("export run --to calculix --step 0 -o base").status, 0);
  EXPECT_NE(read(folder_ / "newest/pull.inp").find("GRAV"), std::string::npos);
  EXPECT_NE(read(folder_ / "newest/README.txt").find("added: gravity"), std::string::npos);
  EXPECT_EQ(read(folder_ / "base/pull.inp").find("GRAV"), std::string::npos);
  const Result none = hookeye("export run --to calculix --step 7 -o other");
  EXPECT_EQ(none.status, 2);
  EXPECT_NE(none.err.find("no step 7"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "other"));
}

/// The table's column of a name, by row.
std::vector<double> column(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  std::string line, cell;
  std::getline(lines, line);
  std::istringstream heads(line);
  int at = -1;
  for (int i = 0; std::getline(heads, cell, ','); ++i)
    if (cell == name) at = i;
  EXPECT_GE(at, 0) << name << " in " << line;
  std::vector<double> out;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    for (int i = 0; i <= at; ++i) {
      cell.clear();
      std::getline(cells, cell, ',');
    }
    out.push_back(cell.empty() ? std::nan("") : std::stod(cell));
  }
  return out;
}

/// Two cameras see a block; it is photographed with mu 0.05.
constexpr const char* kSeenRecipe = R"(hookeye_recipe: 1
title: seen
seed: 3
body: {shape: block, size: [20, 20, 40], mesh: {edge: 10, order: 1}}
material: {law: neo-hookean, true: {mu: 0.05, kappa_over_mu: 12}, told: {mu: 0.05}, fit: [mu]}
cameras: {count: 2, size: [160, 160], focal: 500}
examples:
  rest: {}
  pull: {force: [0, 0, 0.4]}
)";

class DicTables : public Cli {};

TEST_F(DicTables, PhotosTellTheSameWhateverTheModel) {
  write("recipe.yaml", kSeenRecipe);
  ASSERT_EQ(hookeye("synth recipe.yaml -o right").status, 0);
  fs::copy(folder_ / "right", folder_ / "soft", fs::copy_options::recursive);
  std::string yaml = read(folder_ / "soft/capture.yaml");
  yaml.replace(yaml.find("mu: 0.05"), 8, "mu: 0.04");
  yaml.erase(yaml.find("  fit: [mu]"), 11);
  write("soft/capture.yaml", yaml);
  for (const std::string name : {"right", "soft"}) {
    ASSERT_EQ(hookeye("fit " + name + " -o run-" + name).status, 0);
    const Result out = hookeye("export run-" + name + " --to dic -o " + name +
                               "-dic --grid 8 --line 10,0,10:10,0,30");
    ASSERT_EQ(out.status, 0) << out.err;
    EXPECT_TRUE(too_long(out.out).empty());
  }
  const std::string soft = read(folder_ / "soft-dic/pull-cam0.csv");
  const std::string right = read(folder_ / "right-dic/pull-cam0.csv");
  ASSERT_EQ(column(soft, "x [mm]"), column(right, "x [mm]")) << "the same points";
  double models = 0.0, photos = 0.0;
  int told = 0;
  for (const std::string c : {"u", "v", "w"}) {
    const auto soft_model = column(soft, c + " [mm]"), soft_photo = column(soft, c + "_photo [mm]");
    const auto model = column(right, c + " [mm]"), photo = column(right, c + "_photo [mm]");
    for (size_t i = 0; i < model.size(); ++i)
      if (std::isfinite(photo[i] + soft_photo[i])) {
        models += std::pow(soft_model[i] - model[i], 2);
        photos += std::pow(soft_photo[i] - photo[i], 2), ++told;
      }
  }
  EXPECT_GT(told, 100);
  EXPECT_LT(photos, 0.1 * models);
  const auto length = [&](const std::string& name, const char* column_name) {
    return column(read(folder_ / (name + "-dic/lines.csv")), column_name).at(1);
  };
  EXPECT_NEAR(length("soft", "length_photo [mm]"), length("right", "length_photo [mm]"), 0.06);
  EXPECT_GT(length("soft", "length [mm]"), 0.3 + length("right", "length [mm]"));
  EXPECT_NE(read(folder_ / "soft-dic/reporting.csv").find("noise floor of strains,0.0"),
            std::string::npos);
  for (const char* wrong : {"--line 1,2,3", "--line 1,2,3:1,2,3", "--window 4", "--along 0,0,0",
                            "--gauge nothing", "--grid 0"})
    EXPECT_EQ(hookeye(std::string("export run-soft --to dic -o other ") + wrong).status, 2)
        << wrong;
  EXPECT_EQ(hookeye("export run-soft --to json -o other --grid 8").status, 2);
  EXPECT_FALSE(fs::exists(folder_ / "other"));
}

TEST_F(Export, LeavesAFolderThatHoldsSomething) {
  fs::create_directories(folder_ / "empty");
  EXPECT_EQ(hookeye("export run --to json -o empty").status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "empty/model.json"));
  const Result again = hookeye("export run --to json -o empty");
  EXPECT_EQ(again.status, 2);
  write("file", "mine");
  EXPECT_EQ(hookeye("export run --to json -o file").status, 2);
  EXPECT_EQ(read(folder_ / "file"), "mine");
  EXPECT_EQ(hookeye("export run --to nastran -o out").status, 2);
  EXPECT_EQ(hookeye("export nowhere --to json -o out").status, 2);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  for (const auto& entry : fs::directory_iterator(folder_))
    EXPECT_EQ(entry.path().filename().string().find(".part-"), std::string::npos);
}

}  // namespace
}  // namespace hookeye::test
