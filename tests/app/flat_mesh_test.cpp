// A drawn plate with a round hole: what `mesh` and `check` say of its flat tetrahedra, and that the
// command which they name mends it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "app/cli.h"

namespace hookeye::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// 40 x 30 x 6 mm with a hole of radius 1.5 mm in 48 facets, in few triangles as drawing programs
/// write it: each side of the hole goes to the nearest corner of the plate.
std::string plate_with_hole() {
  constexpr int kFacets = 48;
  constexpr double kLow[] = {0.0, 6.0};
  std::string out;
  for (const double z : kLow) {
    for (const auto& [x, y] : {std::pair{20, 15}, {-20, 15}, {-20, -15}, {20, -15}})
      out += fmt::format("v {} {} {}\n", x, y, z);
    for (int i = 0; i < kFacets; ++i) {
      const double a = 2.0 * std::numbers::pi * i / kFacets;
      out += fmt::format("v {:.9f} {:.9f} {}\n", 1.5 * std::cos(a), 1.5 * std::sin(a), z);
    }
  }
  const auto corner = [](int level, int q) { return 1 + level * (4 + kFacets) + q % 4; };
  const auto rim = [](int level, int i) { return 5 + level * (4 + kFacets) + i % kFacets; };
  const auto face = [&](int a, int b, int c, bool turned) {
    out += turned ? fmt::format("f {} {} {}\n", a, c, b) : fmt::format("f {} {} {}\n", a, b, c);
  };
  for (int level = 0; level < 2; ++level) {
    const bool below = level == 0;
    for (int i = 0; i < kFacets; ++i)
      face(corner(level, i / 12), rim(level, i + 1), rim(level, i), below);
    for (int q = 0; q < 4; ++q)
      face(corner(level, q), corner(level, q + 1), rim(level, 12 * (q + 1)), below);
  }
  const auto wall = [&](int a, int b, int c, int d) {  // a, b below; d, c above them
    face(a, b, c, false);
    face(a, c, d, false);
  };
  for (int q = 0; q < 4; ++q) wall(corner(0, q), corner(0, q + 1), corner(1, q + 1), corner(1, q));
  for (int i = 0; i < kFacets; ++i) wall(rim(0, i + 1), rim(0, i), rim(1, i), rim(1, i + 1));
  return out;
}

class FlatMesh : public Cli {
 protected:
  double worst(const std::string& arguments) const {
    const Result meshed = hookeye("mesh --json " + arguments);
    EXPECT_EQ(meshed.status, 0) << meshed.err;
    return json::parse(meshed.out).at("quality").at("min_radius_ratio");
  }
};

TEST_F(FlatMesh, TheAdviceSaysWhatItMeansAndMendsIt) {
  write("plate.obj", plate_with_hole());
  const Result told = hookeye("mesh plate.obj --edge 6 -o plate.vtu");
  ASSERT_EQ(told.status, 0) << told.err;
  EXPECT_THAT(on_one_line(told.out),
              AllOf(HasSubstr("1: regular, 0: flat"), HasSubstr("nearly flat"),
                    HasSubstr("make it too stiff")));
  EXPECT_TRUE(too_long(told.out).empty()) << told.out;
  // The command that it names, as it stands there but for the lines' ends.
  const std::string words = on_one_line(told.out);
  const size_t begin = words.find("`hookeye mesh plate.obj --repair"),
               end = words.find('`', begin + 1);
  ASSERT_NE(begin, std::string::npos) << words;
  const size_t first = begin + std::string("`hookeye ").size();
  const Result mended = hookeye(words.substr(first, end - first));
  ASSERT_EQ(mended.status, 0) << mended.err;
  EXPECT_GT(worst("REMESHED.obj --edge 6 -o again.vtu"),
            3.0 * worst("plate.obj --edge 6 -o a.vtu"));

  // Who repairs already is not sent to the same command again.
  const Result repaired = hookeye("mesh plate.obj --repair -o plate.vtu");
  ASSERT_EQ(repaired.status, 0) << repaired.err;
  EXPECT_THAT(on_one_line(repaired.out),
              AllOf(HasSubstr("nearly flat"), HasSubstr("beside `--repair` it remeshes them"),
                    HasSubstr("volume "), Not(HasSubstr("`hookeye mesh plate.obj --repair"))));

  write_cube("[0, 0, 1]");
  EXPECT_THAT(hookeye("mesh cube.obj -o cube.vtu").out, Not(HasSubstr("nearly flat")));
}

TEST_F(FlatMesh, ACheckSaysItOfAVolumeOtherwise) {
  write("plate.obj", plate_with_hole());
  ASSERT_EQ(hookeye("mesh plate.obj --edge 6 -o plate.vtu").status, 0);
  for (const char* body : {"surface: plate.obj, mesh: {edge: 6}", "volume: plate.vtu"}) {
    write("capture.yaml", fmt::format(R"(hookeye: 1
units: {{length: mm, force: N}}
body: {{{}}}
model:
  material: {{law: neo-hookean, mu: 0.05, kappa: 0.5}}
  fit: [mu]
regions:
  left: {{box: [[-20.1, -16, -1], [-19.9, 16, 7]]}}
  right: {{box: [[19.9, -16, -1], [20.1, 16, 7]]}}
examples:
  pull:
    supports: [{{region: left, fix: [x, y, z]}}]
    loads: [{{region: right, force: [0.1, 0, 0]}}]
)",
                                      body));
    const Result checked = hookeye("check capture.yaml --quick");
    ASSERT_EQ(checked.status, 0) << checked.err;
    const std::string words = on_one_line(checked.out);
    EXPECT_THAT(words, HasSubstr("nearly flat"));
    EXPECT_THAT(words, HasSubstr(body[0] == 's' ? "hookeye mesh plate.obj --repair"
                                                : "The file's own mesher made them"));
  }
}

}  // namespace
}  // namespace hookeye::test
