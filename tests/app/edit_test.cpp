// `hookeye edit` from outside: what it tells of a capture, and what it writes into it.
#include <gmock/gmock.h>

#include <array>

#include "app/served.h"

namespace hookeye::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Edit : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_cube("{z: 1}");
    const std::string text = read(file());
    write("capture.yaml", "# mine\n" + text);
  }
  fs::path file() const { return folder_ / "capture.yaml"; }
  static json state(const Served& editor) { return json::parse(editor.get("state").body); }
  static std::string mark(const Served& editor) { return state(editor)["pulse"]["mark"]; }
  static Served::Answer change(const Served& editor, const std::string& what, json request) {
    if (!request.contains("seen")) request["seen"] = mark(editor);
    return editor.post(what, request.dump());
  }
  static json one(std::vector<std::string> path, const std::string& value) {
    return {{"edits", {{{"path", path}, {"value", value}}}}};
  }
};

#define SERVED_OR_SKIPPED(editor)                                                             \
  const Served editor(folder_, "edit", ".");                                                  \
  if (!editor.ready() && hookeye("edit .").err.find("without its page") != std::string::npos) \
    GTEST_SKIP() << "built without the page";                                                 \
  ASSERT_TRUE(editor.ready())

TEST_F(Edit, TellsWhatTheCaptureHolds) {
  SERVED_OR_SKIPPED(editor);
  const json told = state(editor);
  EXPECT_EQ(told["title"], "cube");
  EXPECT_EQ(told["text"], read(file()));
  EXPECT_TRUE(told["faults"].empty());
  EXPECT_EQ(told["regions"][0]["name"], "base");
  EXPECT_EQ(told["examples"][0]["supports"][1]["along"], json({nullptr, nullptr, 1.0}));
  EXPECT_EQ(told["examples"][0]["supports"][1]["number"], 1);
  const json body = json::parse(editor.get("body").body);
  EXPECT_TRUE(body["of_file"]);
  EXPECT_GT(body["triangles"].get<std::string>().size(), 1000U);
  EXPECT_EQ(editor.get("sight?camera=front").status, 400);
  EXPECT_EQ(editor.get("photo?example=pull&camera=front").status, 404);
}

TEST_F(Edit, WritesAtOnceAndTakesBack) {
  const std::string before = read(file());
  SERVED_OR_SKIPPED(editor);
  const auto done = change(editor, "edit", one({"examples", "pull", "use"}, "validate"));
  ASSERT_EQ(done.status, 200) << done.body;
  std::string expected = before;
  expected += "    use: validate\n";
  EXPECT_EQ(read(file()), expected);
  EXPECT_EQ(json::parse(done.body)["examples"][0]["use"], "validate");
  EXPECT_TRUE(json::parse(done.body)["can_undo"]);
  EXPECT_EQ(change(editor, "undo", json::object()).status, 200);
  EXPECT_EQ(read(file()), before);
  EXPECT_EQ(change(editor, "redo", json::object()).status, 200);
  EXPECT_EQ(read(file()), expected);
  for (const auto& entry : fs::directory_iterator(folder_))
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("tmp"))) << entry.path();
}

TEST_F(Edit, DoesNotWriteOverAnotherProgram) {
  SERVED_OR_SKIPPED(editor);
  const std::string old = mark(editor);
  ASSERT_EQ(change(editor, "edit", one({"title"}, "mine")).status, 200);
  // A page that has not seen that.
  const auto late = change(editor, "text", {{"seen", old}, {"text", "x"}});
  EXPECT_EQ(late.status, 400);
  EXPECT_THAT(late.body, HasSubstr("another window of this page"));
  const std::string theirs = read(file()) + "# theirs\n";
  write("capture.yaml", theirs);
  EXPECT_TRUE(state(editor)["pulse"]["outside"]);
  for (const char* what : {"edit", "undo"}) {
    const auto refused = change(editor, what, one({"title"}, "again"));
    EXPECT_EQ(refused.status, 400);
    EXPECT_THAT(refused.body, HasSubstr("another program has changed it"));
    EXPECT_EQ(read(file()), theirs);
  }
  ASSERT_EQ(change(editor, "reload", json::object()).status, 200);
  EXPECT_EQ(state(editor)["text"], theirs);
  EXPECT_FALSE(state(editor)["pulse"]["outside"]);
  ASSERT_EQ(change(editor, "undo", json::object()).status, 200);
  EXPECT_THAT(read(file()), AllOf(HasSubstr("title: mine"), Not(HasSubstr("# theirs"))));
}

TEST_F(Edit, OpensACaptureWithFaultsAndTellsThemAll) {
  std::string text = read(file());
  text.replace(text.find("law:"), 4, "lau:");
  text += "  push:\n    loads: [{region: nowhere, force: [0, 0, 1]}]\n";
  write("capture.yaml", text);
  SERVED_OR_SKIPPED(editor);
  const json told = state(editor);
  ASSERT_EQ(told["faults"].size(), 2U);
  EXPECT_EQ(told["faults"][0]["file"], told["file"]);
  EXPECT_GT(told["faults"][0]["line"], 1);
  EXPECT_THAT(told["faults"][1]["wrong"].get<std::string>(), HasSubstr("nowhere"));
  EXPECT_EQ(told["examples"].size(), 2U);
  // What is typed is read, and not written.
  const auto tried = editor.post("try", json({{"text", "hookeye: 2\n"}}).dump());
  EXPECT_THAT(tried.body, HasSubstr("this program reads format 1"));
  EXPECT_EQ(read(file()), text);
}

TEST_F(Edit, ChecksEachChange) {
  SERVED_OR_SKIPPED(editor);
  const auto checked = [&] {
    for (int i = 0; i < 600; ++i) {
      const json now = json::parse(editor.get("pulse").body);
      if (now["check"]["state"] != "running" && now["check"].value("mark", "") == now["mark"])
        return now["check"];
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return json();
  };
  json check = checked();
  EXPECT_EQ(check["state"], "done") << check.dump();
  EXPECT_FALSE(check.contains("error"));
  EXPECT_THAT(check["warnings"].dump(), HasSubstr("no example is held out"));
  ASSERT_EQ(change(editor, "edit", one({"model", "material"}, "{law: rubber, mu: 1}")).status, 200);
  check = checked();
  EXPECT_EQ(check["state"], "done") << check.dump();
  ASSERT_TRUE(check.contains("error")) << check.dump();
  EXPECT_GT(check["error"]["line"], 1);
}

TEST_F(Edit, PickedFacesBecomeARegion) {
  {
    SERVED_OR_SKIPPED(editor);
    const json faces{{"name", "side"}, {"triangles", {4, 5}}};
    const auto done = change(editor, "faces", faces);
    ASSERT_EQ(done.status, 200) << done.body;
    EXPECT_EQ(read(folder_ / "side.faces.txt"), "4\n5\n");
    EXPECT_THAT(read(file()), HasSubstr("  side: {faces: side.faces.txt}\n"));
    // The same name again is another file, so that undo finds the first.
    ASSERT_EQ(change(editor, "faces", {{"name", "side"}, {"triangles", {4}}}).status, 200);
    EXPECT_EQ(read(folder_ / "side.faces-2.txt"), "4\n");
    ASSERT_EQ(change(editor, "undo", json::object()).status, 200);
    EXPECT_EQ(state(editor)["regions"][2]["faces"], json({4, 5}));
    for (const char* name : {"../out", ".hidden", ""})
      EXPECT_EQ(change(editor, "faces", {{"name", name}, {"triangles", {4}}}).status, 400) << name;
    EXPECT_FALSE(fs::exists(folder_.parent_path() / "out.faces.txt"));
  }
  EXPECT_TRUE(fs::exists(folder_ / "side.faces.txt"));
  EXPECT_FALSE(fs::exists(folder_ / "side.faces-2.txt")) << "nothing names it";
}

TEST_F(Edit, MovesTheBodyAsACameraSeesIt) {
  write("capture.yaml", read(file()) + R"(    photos: {}
cameras:
  top:
    size: [100, 100]
    projection: orthographic
    intrinsics: {scale: 5, cx: 50, cy: 50}
    pose: {rotation: [[1, 0, 0], [0, -1, 0], [0, 0, -1]], translation: [0, 0, 100]}
)");
  SERVED_OR_SKIPPED(editor);
  const auto done =
      change(editor, "nudge", {{"camera", "top"}, {"move", {1, 2, 0}}, {"turn", {0, 0, 0}}});
  ASSERT_EQ(done.status, 200) << done.body;
  EXPECT_THAT(read(file()), HasSubstr("translation: [1, -2, 0]}"));
  EXPECT_EQ(change(editor, "nudge", {{"camera", "top"}, {"move", {1, 2}}}).status, 400);
  EXPECT_EQ(change(editor, "nudge", {{"camera", "no"}, {"move", {1, 2, 0}}}).status, 400);
}

TEST_F(Edit, PlacesTheBodyByPairs) {
  write("capture.yaml", read(file()) + R"(cameras:
  top:
    size: [200, 200]
    intrinsics: {fx: 600, fy: 600, cx: 100, cy: 100}
    pose: {rotation: [[1, 0, 0], [0, -1, 0], [0, 0, -1]], translation: [0, 0, 100]}
)");
  SERVED_OR_SKIPPED(editor);
  const auto placed = [&](const json& pairs) {
    const json request{{"seen", mark(editor)}, {"pairs", pairs}};
    const auto began = editor.post("place", request.dump());
    if (began.status != 200) return json{{"state", began.body}};
    for (int i = 0; i < 600; ++i) {
      const json now = json::parse(editor.get("pulse").body)["place"];
      if (now["state"] != "running") return now;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return json();
  };
  // The body as it stands, but 1 along x and 2 along -y.
  json pairs = json::array();
  for (const auto& [x, y, z] :
       {std::array{0.0, 0.0, 0.0}, {10, 0, 0}, {0, 10, 0}, {10, 10, 10}, {0, 0, 10}, {10, 0, 10}})
    pairs.push_back({{"camera", "top"},
                     {"pixel", {100 + 600 * (x + 1) / (100 - z), 100 - 600 * (y - 2) / (100 - z)}},
                     {"point", {x, y, z}}});
  const json found = placed(pairs);
  EXPECT_EQ(found["state"], "done") << found.dump();
  EXPECT_THAT(found["message"].get<std::string>(), HasSubstr("off by"));
  const std::string text = read(file());
  const size_t at = text.find("translation: [");
  ASSERT_NE(at, std::string::npos) << text;
  double x = 0, y = 0;
  ASSERT_EQ(std::sscanf(text.c_str() + at, "translation: [%lf, %lf", &x, &y), 2);
  EXPECT_NEAR(x, 1, 1e-3);
  EXPECT_NEAR(y, -2, 1e-3);
  // Two pairs leave it open: told, and nothing is written.
  pairs.erase(pairs.begin(), pairs.begin() + 4);
  EXPECT_EQ(placed(pairs)["state"], "failed");
  EXPECT_EQ(read(file()), text);
  EXPECT_EQ(placed({{{"camera", "no"}, {"pixel", {1, 1}}, {"point", {0, 0, 0}}}})["state"]
                .get<std::string>()
                .find("done"),
            std::string::npos);
}

TEST_F(Edit, RefusesWhatItDoesNotUnderstandAndWhatComesFromElsewhere) {
  const std::string before = read(file());
  SERVED_OR_SKIPPED(editor);
  const json good{{"seen", mark(editor)}, {"text", "x"}};
  EXPECT_EQ(editor.post_from_elsewhere("text", good.dump()).status, 403);
  for (const char* what :
       {"text", "edit", "faces", "nudge", "place", "undo", "redo", "reload", "try"})
    for (const char* body : {"", "{", "[]", "{\"seen\": 1}"})
      EXPECT_EQ(editor.post(what, body).status, 400) << what << " " << body;
  for (const char* path : {"[]", "[1]", "\"a\"", "[\"nothing\", \"here\"]"}) {
    const std::string body =
        "{\"seen\": \"" + mark(editor) + "\", \"edits\": [{\"path\": " + path + "}]}";
    EXPECT_EQ(editor.post("edit", body).status, 400) << path;
  }
  EXPECT_EQ(editor.get("../state").status, 404);
  EXPECT_EQ(read(file()), before);
  const Result second = hookeye("edit .");
  EXPECT_EQ(second.status, 2);
  EXPECT_THAT(second.err, HasSubstr("an editor is open on this capture already"));
}

TEST_F(Cli, AnEditorWithoutACaptureSaysWhatToDo) {
  const Result result = hookeye("edit .");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("`hookeye new FOLDER` proposes one"));
}

}  // namespace
}  // namespace hookeye::test
