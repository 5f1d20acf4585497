// hookeye new from outside: its questions, its exit status, the capture that check takes.
#include <gmock/gmock.h>

#include "app/cli.h"
#include "capture_io/image.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

/// A cube of 10 mm, one camera, eight photos, eight rows.
void write_lab(const fs::path& folder, const std::function<void(std::string, std::string)>& write) {
  write("cube.obj",
        "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nv 0 0 10\nv 10 0 10\nv 10 10 10\nv 0 10 10\n"
        "f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\n"
        "f 4 1 5\nf 4 5 8\n");
  write("camera.yml",
        "%YAML:1.0\n---\nimage_width: 64\nimage_height: 48\n"
        "camera_matrix: [ 200., 0., 31.5, 0., 200., 23.5, 0., 0., 1. ]\n"
        "R: [ 1., 0., 0., 0., 0., -1., 0., 1., 0. ]\nT: [ -5., 5., 60. ]\n");
  std::string table = "Zeit in s;Weg in mm;Kraft in N\n";
  for (int i = 0; i < 8; ++i) {
    table += std::to_string(i) + ",0;0," + std::to_string(i) + ";0," + std::to_string(i) + "\n";
    Image image{64, 48, 1, {}};
    for (int k = 0; k < 64 * 48; ++k)
      image.values.push_back(0.5f + 0.01f * static_cast<float>((k * 2654435761u >> 7) % 17));
    write_image(folder / ("shot_" + std::to_string(i) + ".tif"), image);
  }
  write("machine.csv", table);
}

TEST_F(Cli, NewAsksAndTellsHowToAnswer) {
  write_lab(folder_, [&](const auto& name, const auto& text) { write(name, text); });
  const Result asked = hookeye("new .");
  EXPECT_EQ(asked.status, 2);
  EXPECT_THAT(asked.err, HasSubstr("--set held=-x"));
  EXPECT_THAT(asked.err, HasSubstr("--set mu="));
  EXPECT_FALSE(fs::exists(folder_ / "capture.yaml"));
  const Result unknown = hookeye("new . --yes --set hold=+z");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean `held`?"));
  EXPECT_THAT(hookeye("new . --yes --set held").err, HasSubstr("--set NAME=VALUE"));
  EXPECT_THAT(hookeye("new nowhere --yes").err, HasSubstr("there is no such folder"));
  EXPECT_FALSE(fs::exists(folder_ / "capture.yaml"));
}

TEST_F(Cli, NewWritesWhatCheckTakes) {
  write_lab(folder_, [&](const auto& name, const auto& text) { write(name, text); });
  const std::string told = " --yes --set held=-z --set pulled=+z --set drive=force";
  const Result made = hookeye("new ." + told + " --json");
  ASSERT_EQ(made.status, 0) << made.err;
  const json document = json::parse(made.out);
  EXPECT_EQ(document["pairing"], "a row a photo: 8 of each");
  EXPECT_EQ(document["check"]["command"], "check");
  EXPECT_EQ(document["check"]["examples"].size(), 7u);
  EXPECT_NEAR(document["check"]["regions"][0]["area"].get<double>(), 100.0, 1e-6);
  const std::string capture = read(folder_ / "capture.yaml");
  EXPECT_THAT(capture, HasSubstr("force: [0, 0, 0.7]"));
  EXPECT_EQ(hookeye("check . --quick").status, 0);
  // It stays unless told otherwise.
  EXPECT_EQ(hookeye("new ." + told).status, 2);
  const Result beside = hookeye("new . -o second.yaml --no-check" + told);
  ASSERT_EQ(beside.status, 0) << beside.err;
  EXPECT_TRUE(too_long(beside.out).empty()) << beside.out;
  EXPECT_EQ(read(folder_ / "second.yaml"), capture);
  EXPECT_EQ(hookeye("new . --force --no-check" + told + " --set cases=3").status, 0);
  EXPECT_NE(read(folder_ / "capture.yaml"), capture);
}

}  // namespace
}  // namespace hookeye::test
