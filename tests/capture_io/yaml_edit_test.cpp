// One value of a text that somebody wrote is changed, and nothing else of it.
#include "capture_io/yaml_edit.h"

#include <gmock/gmock.h>

#include "capture_io/capture_folder.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

std::string set(const std::string& text, std::vector<std::string> path, const std::string& value) {
  return edited_yaml(text, "capture.yaml", {.path = std::move(path), .value = value});
}
std::string removed(const std::string& text, std::vector<std::string> path) {
  return edited_yaml(text, "capture.yaml", {.path = std::move(path)});
}

const std::string kText = R"(# mine
hookeye: 1
title: a block, pulled  # of silicone
regions:
  base: {box: [[0, 0, 0], [1, 1, 0]]}   # the table
  # the jaw
  grip:
    sphere:
      center: [0, 0, 5]
      radius: 2

examples:
  rest: {}
  pull:   # photo 7
    use: fit
    supports:
      - {region: base, fix: [x, y, z]}
      # free to turn
      - region: grip
        move: {z: 1.5}
    loads: [{region: grip, force: [0, 0, 2]}]
  # the end
)";

/// `kText` with a piece of it replaced.
std::string with(const std::string& from, const std::string& to) {
  std::string text = kText;
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(YamlEdit, ReplacesAValue) {
  EXPECT_EQ(set(kText, {"title"}, "\"x\""), with("a block, pulled  #", "\"x\"  #"));
  EXPECT_EQ(set(kText, {"examples", "pull", "use"}, "test"), with("use: fit", "use: test"));
  EXPECT_EQ(set(kText, {"examples", "pull", "loads", "0", "force"}, "[1, 0, 0]"),
            with("force: [0, 0, 2]", "force: [1, 0, 0]"));
  EXPECT_EQ(set(kText, {"examples", "pull", "supports", "0"}, "{region: grip, fix: [x]}"),
            with("{region: base, fix: [x, y, z]}", "{region: grip, fix: [x]}"));
  EXPECT_EQ(set(kText, {"regions", "base", "box"}, "[[0, 0, 0], [2, 2, 0]]"),
            with("[[0, 0, 0], [1, 1, 0]]", "[[0, 0, 0], [2, 2, 0]]"));
  // A block becomes a line; what stands behind its key stays.
  EXPECT_EQ(set(kText, {"regions", "grip"}, "{faces: a.txt}"),
            with("grip:\n    sphere:\n      center: [0, 0, 5]\n      radius: 2\n",
                 "grip: {faces: a.txt}\n"));
  EXPECT_EQ(set(kText, {"examples", "pull", "supports", "1"}, "{region: base, fix: [x]}"),
            with("region: grip\n        move: {z: 1.5}\n", "{region: base, fix: [x]}\n"));
}

TEST(YamlEdit, AddsAKeyOrAnItem) {
  EXPECT_EQ(set(kText, {"regions", "side"}, "{group: side}"),
            with("      radius: 2\n", "      radius: 2\n  side: {group: side}\n"));
  EXPECT_EQ(set(kText, {"examples", "pull", "supports", "+"}, "{region: base, rigid: fit}"),
            with("        move: {z: 1.5}\n",
                 "        move: {z: 1.5}\n      - {region: base, rigid: fit}\n"));
  EXPECT_EQ(set(kText, {"examples", "pull", "loads", "+"}, "{region: base, pressure: 1}"),
            with("force: [0, 0, 2]}]", "force: [0, 0, 2]}, {region: base, pressure: 1}]"));
  EXPECT_EQ(set(kText, {"examples", "rest", "use"}, "test"), with("rest: {}", "rest: {use: test}"));
  EXPECT_EQ(set(kText, {"examples", "twist"}, "{}"),
            with("force: [0, 0, 2]}]\n", "force: [0, 0, 2]}]\n  twist: {}\n"));
}

TEST(YamlEdit, MakesWhatIsMissingOnTheWay) {
  EXPECT_EQ(set(kText, {"examples", "rest", "supports", "+"}, "{region: base, fix: [x]}"),
            with("rest: {}", "rest: {supports: [{region: base, fix: [x]}]}"));
  EXPECT_EQ(
      set("a: 1\nexamples:\n  pull:\n    use: fit", {"examples", "pull", "loads", "+"}, "{p: 1}"),
      "a: 1\nexamples:\n  pull:\n    use: fit\n    loads:\n      - {p: 1}\n");
  EXPECT_EQ(set("a: 1\r\n", {"regions", "base"}, "{group: b}"),
            "a: 1\r\nregions:\r\n  base: {group: b}\r\n");
  EXPECT_EQ(edited_yaml("a: 1\n# cases\nexamples: {}\n", "c",
                        {{"regions", "top"}, "{}", false, "examples"}),
            "a: 1\nregions:\n  top: {}\n# cases\nexamples: {}\n");
  EXPECT_EQ(set("regions:\nb: 1\n", {"regions", "base"}, "{group: b}"),
            "regions:\n  base: {group: b}\nb: 1\n");
  EXPECT_EQ(set("e:\n  supports:\n  - 1\n  loads: []\n", {"e", "supports", "+"}, "2"),
            "e:\n  supports:\n  - 1\n  - 2\n  loads: []\n");
}

TEST(YamlEdit, RemovesAValueWithItsKey) {
  EXPECT_EQ(removed(kText, {"regions", "grip"}),
            with("  grip:\n    sphere:\n      center: [0, 0, 5]\n      radius: 2\n", ""));
  EXPECT_EQ(removed(kText, {"examples", "pull", "supports", "0"}),
            with("      - {region: base, fix: [x, y, z]}\n", ""));
  EXPECT_EQ(removed(kText, {"examples", "pull", "supports", "1"}),
            with("      - region: grip\n        move: {z: 1.5}\n", ""));
  // A list without items goes; a map stays.
  EXPECT_EQ(removed(kText, {"examples", "pull", "loads", "0"}),
            with("    loads: [{region: grip, force: [0, 0, 2]}]\n", ""));
  EXPECT_EQ(removed("a: {b: 1}\nc: 2\n", {"a", "b"}), "a: {}\nc: 2\n");
  EXPECT_EQ(removed("a: [1, 2, 3]\n", {"a", "1"}), "a: [1, 3]\n");
  EXPECT_EQ(removed("a: [1, 2, 3]\n", {"a", "2"}), "a: [1, 2]\n");
}

TEST(YamlEdit, SpecialNamesAreQuoted) {
  EXPECT_EQ(set("a: {}\n", {"a", "no"}, "1"), "a: {\"no\": 1}\n");
  EXPECT_EQ(set("a: {}\n", {"a", "b: c"}, "1"), "a: {\"b: c\": 1}\n");
}

TEST(YamlEdit, IsRefusedWhereMoreWouldChangeOrNothingIs) {
  const std::string aliased = "old: &b {x: 1}\nbody: *b\n";
  const auto complaint = [](const auto& work) -> std::string {
    try {
      work();
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_THAT(complaint([&] {
                set(aliased, {"body", "x"}, "2");
              }),
              HasSubstr("without changing more of it\n  write it by hand: `x: 2`"));
  EXPECT_THAT(complaint([&] { set("a: 1\n", {"a", "b"}, "2"); }), HasSubstr("cannot be changed"));
  EXPECT_THAT(complaint([&] { set("a: 1\n", {"a"}, "1\nb: 2"); }), HasSubstr("cannot be changed"));
  EXPECT_THAT(complaint([&] { set("a: 1\n", {"a"}, "[1"); }), HasSubstr("the new value"));
  EXPECT_THAT(complaint([&] { removed("a: 1\n", {"b"}); }), HasSubstr("there is no `b`"));
  EXPECT_THAT(complaint([&] { set("a: |\n  words\n  more\n", {"a"}, "x"); }),
              HasSubstr("cannot be changed"));
}

TEST(StoreCapture, WritesWhatTheReaderTakesAndNothingElse) {
  const CaptureFixture fixture;
  fixture.write();
  const auto file = fixture.folder() / "capture.yaml";
  const std::string before = read_text(file);
  store_capture(file, before + "# more\n", true);
  EXPECT_EQ(read_text(file), before);
  EXPECT_THROW(store_capture(file, before + "more: 1\n"), InputError);
  EXPECT_EQ(read_text(file), before);
  store_capture(file, before + "# more\n");
  EXPECT_EQ(read_text(file), before + "# more\n");
  for (const auto& entry : std::filesystem::directory_iterator(fixture.folder()))
    EXPECT_FALSE(entry.path().filename().string().starts_with(".tried")) << entry.path();
}

}  // namespace
}  // namespace hookeye::test
