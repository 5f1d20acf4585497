// hookeye export from outside: folders, warnings, exit status.
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
