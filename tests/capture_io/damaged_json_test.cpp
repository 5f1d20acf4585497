// run.json and other JSON that is damaged or another's.
#include <gmock/gmock.h>

#include "capture_io/run.h"
#include "core/json_file.h"
#include "core/text_file.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

template <class Action>
std::string refusal(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    EXPECT_FALSE(error.right().empty());
    return error.what();
  }
  return "nothing was refused";
}

std::string nested(const std::string& open, const std::string& close, int depth) {
  std::string text;
  for (int i = 0; i < depth; ++i) text += open;
  text += "1";
  for (int i = 0; i < depth; ++i) text += close;
  return text;
}

TEST(DamagedJson, IsToldInWords) {
  std::string damage;
  EXPECT_TRUE(parse_json("{\"a\": [1, \"[[{\\\"{[\", {}]}", damage));
  EXPECT_TRUE(parse_json(nested("[", "]", 100), damage));
  const std::pair<std::string, std::string> cases[] = {
      {"{\"a\": [1", "damaged (cut short at byte 8)"},
      {"{\"a\": oh}", "damaged (not JSON from byte 7 on)"},
      {"", "damaged (cut short at byte 0)"},
      {"[1e999]", "damaged (it holds a number that is none)"},
      {nested("[", "]", 101), "damaged (nested deeper than 100)"},
      {nested("[", "]", 200000), "damaged (nested deeper than 100)"},
      {nested("{\"a\":", "}", 200000), "damaged (nested deeper than 100)"}};
  for (const auto& [text, told] : cases) {
    EXPECT_FALSE(parse_json(text, damage)) << text.substr(0, 20);
    EXPECT_EQ(damage, told);
  }
}

TEST(DamagedJson, ShapesNameTheValueThatIsNot) {
  const json shape = {{"name", "text"},
                      {"?chi", "number|null"},
                      {"?steps", json::array({{{"name", "text"}, {"?on", "flag"}}})},
                      {"?place", json::array({"number", "number"})},
                      {"?by_camera", {{"*", "number"}}}};
  const auto told = [&](const json& value) {
    return refusal([&] { expect_shape(value, shape, "run.json"); });
  };
  EXPECT_EQ(told({{"name", "a"},
                  {"chi", nullptr},
                  {"steps", json::array({{{"name", "b"}, {"on", true}, {"more", 1}}})},
                  {"place", {1, 2.5}},
                  {"by_camera", {{"left", 1}}},
                  {"unknown", 3}}),
            "nothing was refused");
  EXPECT_THAT(told(5), HasSubstr("run.json: it is a number, where a map is expected"));
  EXPECT_THAT(told(json::object()), HasSubstr("it lacks `name`"));
  EXPECT_THAT(told({{"name", 1}}), HasSubstr("`name` is a number, where a text is expected"));
  EXPECT_THAT(told({{"name", "a"}, {"chi", "x"}}), HasSubstr("`chi` is a text"));
  EXPECT_THAT(told({{"name", "a"}, {"steps", {{{"name", "b"}}, {{"on", true}}}}}),
              HasSubstr("`steps/1` lacks `name`"));
  EXPECT_THAT(told({{"name", "a"}, {"steps", json::array({7})}}),
              HasSubstr("`steps/0` is a number"));
  EXPECT_THAT(told({{"name", "a"}, {"place", {1, 2, 3}}}), HasSubstr("a list of 2 is expected"));
  EXPECT_THAT(told({{"name", "a"}, {"by_camera", {{"left", "x"}}}}),
              HasSubstr("`by_camera/left` is a text"));
}

TEST(DamagedTimeline, IsRefusedWithItsFile) {
  const TemporaryFolder folder;
  const auto told = [&](const std::string& text) {
    write_text(folder / "run.json", text);
    return refusal([&] { Run::open(folder.path(), false); });
  };
  const std::string head = R"({"hookeye": 1, "capture": "/a/capture.yaml", )";
  EXPECT_EQ(told(head + R"("steps": [{"name": "base"}]})"), "nothing was refused");
  const std::pair<std::string, std::string> cases[] = {
      {R"("steps": [{}]})", "`steps/0` lacks `name`"},
      {R"("steps": [{"name": "base"}, {"name": 5}]})", "`steps/1/name` is a number"},
      {R"("steps": [5]})", "`steps/0` is a number, where a map is expected"},
      {R"("steps": {}})", "`steps` is a map, where a list is expected"},
      {R"("steps": [{"name": "../../etc"}]})", "the name of a step is no name of a folder"},
      {R"("steps": [{"name": ""}]})", "the name of a step is no name of a folder"},
      {R"("fingerprints": 5, "steps": []})", "`fingerprints` is a number"},
      {R"("fingerprints": {"a": 5}, "steps": []})", "`fingerprints/a` is a number"},
      {R"("steps": )" + nested("[", "]", 200000) + "}", "nested deeper than 100"}};
  for (const auto& [rest, wrong] : cases)
    EXPECT_THAT(told(head + rest), AllOf(HasSubstr("run.json: "), HasSubstr(wrong)));
  EXPECT_THAT(told(R"({"hookeye": 1, "steps": []})"), HasSubstr("it lacks `capture`"));
  EXPECT_THAT(told(R"({"hookeye": 2, "capture": "", "steps": []})"), HasSubstr("in format 1"));
  EXPECT_THAT(told("[]"), HasSubstr("in format 1"));
}

}  // namespace
}  // namespace hookeye::test
