// Which captures are meant: by folders, patterns, lists and tables, and what is wrong with a list.
#include "batch/capture_list.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class CaptureList : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"a", "b", "deep/c"}) {
      std::filesystem::create_directories(folder_ / name);
      write(std::string(name) + "/capture.yaml", "hookeye: 1\n");
    }
    write("a/other.yaml", "hookeye: 1\n");
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  std::vector<ListedCapture> read(const std::string& word) const {
    return read_capture_list({(folder_ / word).string()}, [](const std::string& name) {
      return name == "set"     ? OptionKind::valued
             : name == "quick" ? OptionKind::flag
                               : OptionKind::unknown;
    });
  }
  std::vector<std::string> labels(const std::string& word) const {
    std::vector<std::string> out;
    for (const ListedCapture& one : read(word)) out.push_back(one.label);
    return out;
  }
  std::string fault_of(const std::string& word) const {
    try {
      read(word);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no fault";
  }
  TemporaryFolder folder_;
};

TEST_F(CaptureList, FoldersFilesAndPatterns) {
  EXPECT_THAT(labels(""), ElementsAre("a", "b", "c"));
  EXPECT_THAT(labels("a"), ElementsAre("a"));
  EXPECT_THAT(labels("a/other.yaml"), ElementsAre("a-other"));
  EXPECT_THAT(labels("[ab]"), ElementsAre("a", "b"));
  EXPECT_THAT(labels("*/*/capture.yaml"), ElementsAre("c"));
  EXPECT_EQ(read("a")[0].capture, folder_ / "a/capture.yaml");
}

TEST_F(CaptureList, ATextListIsRelativeToItself) {
  write("deep/list.txt", "# mine\n../a   # the first\n\nc/capture.yaml\n");
  EXPECT_THAT(labels("deep/list.txt"), ElementsAre("a", "c"));
  write("list.txt", "a\nnowhere\n");
  EXPECT_THAT(fault_of("list.txt"), HasSubstr("list.txt:2: there is no "));
}

TEST_F(CaptureList, ATableHasOptionsARow) {
  write("table.csv",
        "\xef\xbb\xbf"
        "name,capture,set,quick\r\n"
        "\"one, \"\"the\"\" first\",a,fit.pixels=0; floor.at=1.2,yes\r\n"
        ",b,,no\r\n");
  const auto found = read("table.csv");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].label, "one, \"the\" first");
  EXPECT_THAT(found[0].options,
              ElementsAre("--set", "fit.pixels=0", "--set", "floor.at=1.2", "--quick"));
  EXPECT_EQ(found[1].label, "b");
  EXPECT_THAT(found[1].options, IsEmpty());
  write("semicolons.csv", "capture;set\na;x=1\n");
  EXPECT_THAT(read("semicolons.csv")[0].options, ElementsAre("--set", "x=1"));
}

TEST_F(CaptureList, FaultsAreToldWithTheirLine) {
  const std::pair<std::string, std::string> faults[] = {
      {"photo\na\n", "table.csv:1: the table has no column `capture`"},
      {"capture,colour\na,red\n", "table.csv:1: the verb has no option --colour"},
      {"capture,set\na,x=1\nb\n", "table.csv:3: 1 cells stand below 2 columns"},
      {"capture,quick\na,maybe\n",
       "table.csv:2: `quick` takes no value, and its cell holds 'maybe'"},
      {"capture\n\"a\n", "table.csv:2: a quote is not closed"},
      {"capture,set\n\"a\"b,\n", "table.csv:2: text stands behind a closing quote"},
      {"capture\nnone\n", "table.csv:2: there is no "}};
  for (const auto& [text, said] : faults) {
    write("table.csv", text);
    EXPECT_THAT(fault_of("table.csv"), HasSubstr(said));
  }
  std::filesystem::create_directories(folder_ / "empty");
  EXPECT_THAT(fault_of("empty"), HasSubstr("no capture.yaml lies in"));
}

}  // namespace
}  // namespace hookeye::test
