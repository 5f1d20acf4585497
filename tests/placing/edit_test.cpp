// A placement goes into a capture that somebody wrote, and nothing else changes.
#include "placing/edit.h"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "placing/placed_capture.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

ToldPlacement some_place(bool fit = false) {
  ToldPlacement out;
  out.R = Eigen::AngleAxisd(0.4, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  out.t = Vector3d(1.5, -20, 300.25);
  out.fit = fit;
  return out;
}

std::string capture(const std::string& body) {
  return "# mine\nhookeye: 1\nunits: {length: mm, force: N}\n" + body +
         "model:   # guessed\n  material: {law: neo-hookean, mu: 0.05, kappa: 0.5}\n"
         "examples:\n  rest: {}\n";
}

/// `from` with each line of `to` that is not in it, and without the others: what an edit did.
std::string placed_lines(const std::string& body, bool fit = false) {
  const std::string before = capture(body);
  const std::string after = placed_text(before, "capture.yaml", some_place(fit));
  const std::string line = "placement: " + placement_text(some_place(fit));
  EXPECT_THAT(after, HasSubstr(line));
  std::string left = after;
  left.replace(left.find(line), line.size(), "PLACED");
  const size_t tail = capture("").size() - capture("").find("model:");
  return left.substr(before.find("body:"), left.size() - tail - before.find("body:"));
}

TEST(PlacedText, IsAddedBelowBody) {
  EXPECT_EQ(placed_lines("body:  # silicone\n  # scanned\n  surface: rest.obj\n  density: 1\n"),
            "body:  # silicone\n  PLACED\n  # scanned\n  surface: rest.obj\n  density: 1\n");
  EXPECT_EQ(placed_lines("body:\r\n    surface: rest.obj\r\n"),
            "body:\r\n    PLACED\r\n    surface: rest.obj\r\n");
  EXPECT_EQ(placed_lines("body: {surface: rest.obj}  # one line\n"),
            "body: {PLACED, surface: rest.obj}  # one line\n");
  EXPECT_EQ(placed_lines("body: {surface: rest.obj,\n       density: 1}\n"),
            "body: {PLACED, surface: rest.obj,\n       density: 1}\n");
}

TEST(PlacedText, ReplacesAnOldOne) {
  EXPECT_EQ(
      placed_lines("body:\n  surface: rest.obj\n  placement: given  # where?\n  density: 1\n"),
      "body:\n  surface: rest.obj\n  PLACED  # where?\n  density: 1\n");
  EXPECT_EQ(placed_lines("body: {surface: rest.obj, placement: fit}\n", true),
            "body: {surface: rest.obj, PLACED}\n");
  const std::string old =
      "{rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],  # ] old\n    translation: [0, 0, 1]}";
  EXPECT_EQ(placed_lines("body:\n  placement: " + old + "   # told\n  surface: rest.obj\n"),
            "body:\n  PLACED   # told\n  surface: rest.obj\n");
  const std::string block =
      "  placement:\n    rotation:\n      - [1, 0, 0]\n      - [0, 1, 0]\n      - [0, 0, 1]\n"
      "    translation: [0, 0, 1]\n";
  EXPECT_EQ(placed_lines("body:\n" + block + "  # kept\n  surface: rest.obj\n"),
            "body:\n  PLACED\n  # kept\n  surface: rest.obj\n");
  EXPECT_EQ(placed_lines("body:\n  surface: rest.obj\n" + block),
            "body:\n  surface: rest.obj\n  PLACED\n");
}

TEST(PlacedText, IsRefusedWhereMoreWouldChange) {
  const std::string text =
      "hookeye: 1\nunits: &u {length: mm, force: N}\nold: &b {surface: rest.obj}\nbody: *b\n";
  try {
    placed_text(text, "capture.yaml", some_place());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().line, 4);
    EXPECT_THAT(error.right(), HasSubstr("placement: {rotation: [["));
  }
}

TEST(PlacedText, IsReadAsItWasFound) {
  const auto told = placement_of_capture(
      parse_yaml(placed_text(capture("body: {surface: a.obj}\n"), "c", some_place(true)), "c"));
  EXPECT_LT((told.R - some_place().R).norm(), 1e-9);
  EXPECT_LT((told.t - some_place().t).norm(), 1e-7);
  EXPECT_TRUE(told.fit);
}

TEST(StorePlaced, WritesTheFileWholeOrNotAtAll) {
  const PlacedCapture placed({}, Isometry3d::Identity());
  const auto text = [&] {
    std::ostringstream out;
    out << std::ifstream(placed.file()).rdbuf();
    return out.str();
  };
  const std::string before = text();
  store_placed(placed.file(), some_place(), true);
  EXPECT_EQ(text(), before);
  store_placed(placed.file(), some_place(), false);
  EXPECT_NE(text(), before);
  const Capture read = read_capture(placed.file());
  const Camera& told = placed.capture().cameras[0];
  // The told place undone, the new one in its stead.
  const Vector3d X(3, 4, 5);
  const Vector3d in_cameras = some_place().R * X + some_place().t;
  const Vector3d as_told = placed.told().R.transpose() * (in_cameras - placed.told().t);
  EXPECT_LT((read.cameras[0].project(X) - told.project(as_told)).norm(), 1e-5);
  for (const auto& entry : std::filesystem::directory_iterator(placed.folder().path()))
    EXPECT_FALSE(entry.path().filename().string().starts_with(".tried")) << entry.path();
}

}  // namespace
}  // namespace hookeye::test
