// synth on a surface of the user's own: regions, speckles in space, a hidden effect at a told
// place.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/input_error.h"
#include "core/text_file.h"
#include "estimation/model/model.h"
#include "estimation/synth/synth.h"
#include "support/temporary_folder.h"

namespace hookeye {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A bar of 12 x 10 x 30 mm that lies along y, off the origin, as an STL writes it.
std::string bar_stl() {
  const Vector3d low(100, -50, 7), size(12, 30, 10);
  const auto corner = [&](int i) {
    return Vector3d(low + Vector3d(i & 1, i >> 1 & 1, i >> 2 & 1).cwiseProduct(size));
  };
  const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  std::string text = "solid bar\n";
  for (const auto& quad : quads)
    for (const int first : {1, 2}) {
      text += "facet normal 0 0 0\nouter loop\n";
      for (const int i : {quad[0], quad[first], quad[first + 1]})
        text += fmt::format("vertex {} {} {}\n", corner(i).x(), corner(i).y(), corner(i).z());
      text += "endloop\nendfacet\n";
    }
  return text + "endsolid bar\n";
}

const char* const kRecipe = R"(hookeye_recipe: 1
seed: 3
body:
  surface: bar.stl
  mesh: {edge: 6}
  texture: {texel: 0.2, speckle: 1.5}
regions:
  base: {halfspace: {point: [0, -49.9, 0], normal: [0, -1, 0]}}
  grip: {halfspace: {point: [0, -20.1, 0], normal: [0, 1, 0]}}
  spot: {sphere: {center: [112, -30, 12], radius: 4}}
material: {law: neo-hookean, true: {mu: 0.02, kappa_over_mu: 10}, fit: [mu]}
cameras: {count: 2, size: [120, 120], distance: 6, focal: 420}
examples:
  rest: {}
  pull: {force: [0, 0.9, 0]}
  bend: {move: [0, 1, 4]}
  poke: {use: validate, region: spot, force: [-0.05, 0, 0]}
)";
const char* const kFast = "truth: {edge_factor: 1, rays_per_axis: 2, visibility_rays: 0}\n";
const char* const kInclusion =
    "hidden:\n  - {effect: stiffness_field, variant: free ball, values: {stiffness_field.a: 1.1, "
    "stiffness_field.x: 106, stiffness_field.y: -38, stiffness_field.z: 12, "
    "stiffness_field.radius: 4, stiffness_field.thickness: 0.6}}\n";

class SynthSurface : public testing::Test {
 protected:
  SynthSurface() { write_text(folder_ / "bar.stl", bar_stl()); }
  Recipe recipe(const std::string& text) {
    write_text(folder_ / "recipe.yaml", text);
    return read_recipe(folder_ / "recipe.yaml");
  }
  Synthesis make(const std::string& text) {
    return synthesize(recipe(text), folder_ / "capture").value();
  }
  std::string fault(const std::string& text) {
    try {
      make(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no fault";
  }
  test::TemporaryFolder folder_;
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST_F(SynthSurface, MakesACaptureOfItWithAnInclusionWhereItWasTold) {
  const Synthesis made = make(std::string(kRecipe) + kInclusion + kFast);
  const auto scene = load_scene(read_capture(made.capture));
  EXPECT_NEAR(scene->body->regions.at("grip").area, 120.0, 1e-6);
  EXPECT_NEAR(scene->body->regions.at("base").centroid.y(), -50.0, 1e-9);
  EXPECT_GT(scene->body->regions.at("spot").area, 10.0);
  // forces and motions are the capture's own: nothing scales them
  EXPECT_EQ(*scene->capture.examples[1].loads.at(0).force, Vector3d(0, 0.9, 0));
  EXPECT_EQ(scene->capture.examples[2].supports.at(1).rigid.move, Vector3d(0, 1, 4));
  const auto truth = nlohmann::json::parse(read_text(made.truth)).at("hidden").at(0);
  EXPECT_EQ(truth.at("variant"), "free ball");
  EXPECT_EQ(truth.at("values").at("stiffness_field.y"), -38.0);
  EXPECT_GT(made.hidden.at(0).rms_px, 0.02);
  EXPECT_THAT(made.hidden.at(0).sentence, HasSubstr("around (106"));
}

/// Asked for a size in the pictures, an inclusion grows stiffer and stays where it is.
TEST_F(SynthSurface, ScalingKeepsThePlace) {
  const std::string text =
      std::string(kRecipe) + replaced(kInclusion, "0.6}}", "0.6}, rms_px: 0.1}") + kFast;
  const Synthesis made = make(text);
  EXPECT_NEAR(made.hidden.at(0).rms_px, 0.1, 0.004);
  const auto values = nlohmann::json::parse(read_text(made.truth)).at("hidden").at(0).at("values");
  EXPECT_EQ(values.at("stiffness_field.x"), 106.0);
  EXPECT_EQ(values.at("stiffness_field.radius"), 4.0);
  EXPECT_NE(values.at("stiffness_field.a"), 1.1);
}

/// Bilinear, as textures are read.
double grey(const Image& image, const Eigen::Vector2d& uv) {
  const double x = uv.x() * image.width - 0.5, y = (1.0 - uv.y()) * image.height - 0.5;
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const double s = x - i, t = y - j;
  return (1 - t) * ((1 - s) * image.at(i, j) + s * image.at(i + 1, j)) +
         t * ((1 - s) * image.at(i, j + 1) + s * image.at(i + 1, j + 1));
}

/// Along an edge both triangles show the same speckles, which cover as much as was asked for.
TEST_F(SynthSurface, SpecklesGoOnAcrossSeams) {
  const Synthesis made = make(std::string(kRecipe) + kFast);
  const SurfaceMesh surface = read_surface(made.capture / "surface.obj");
  const Image albedo = read_image(made.capture / "albedo.png", Encoding{});
  ASSERT_EQ(surface.uv.size(), 12U);
  std::map<std::pair<int, int>, std::vector<std::array<Eigen::Vector2d, 2>>> sides;
  for (size_t t = 0; t < surface.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = surface.triangles[t][k], b = surface.triangles[t][(k + 1) % 3];
      const auto &at_a = surface.uv[t][k], &at_b = surface.uv[t][(k + 1) % 3];
      sides[std::minmax(a, b)].push_back(a < b ? std::array{at_a, at_b} : std::array{at_b, at_a});
    }
  ASSERT_EQ(sides.size(), 18U);
  int dark = 0, all = 0;
  double worst = 0.0;
  for (const auto& [edge, seen] : sides) {
    ASSERT_EQ(seen.size(), 2U);
    for (double s = 0.0; s <= 1.0; s += 1.0 / 64.0) {
      const double one = grey(albedo, (1.0 - s) * seen[0][0] + s * seen[0][1]);
      const double other = grey(albedo, (1.0 - s) * seen[1][0] + s * seen[1][1]);
      worst = std::max(worst, std::abs(one - other));
      dark += one < 0.5, ++all;
    }
  }
  // A texel's fifth of a millimetre against edges half a millimetre soft, of 0.6 contrast.
  EXPECT_LT(worst, 0.15);
  EXPECT_NEAR(static_cast<double>(dark) / all, 0.5, 0.12);
}

TEST_F(SynthSurface, FaultsSayWhereAndWhatIsRight) {
  const std::string text = std::string(kRecipe) + kFast;
  EXPECT_THAT(fault(replaced(text, "bar.stl", "bra.stl")),
              AllOf(HasSubstr("recipe.yaml:4:12:"), HasSubstr("bar.stl")));
  EXPECT_THAT(fault(replaced(text, "  mesh:", "  taper: 1\n  mesh:")),
              AllOf(HasSubstr("recipe.yaml:5:10: `taper` is of a drawn shape"),
                    HasSubstr("leave `surface` or `taper` out")));
  EXPECT_THAT(fault(replaced(text, "  base:", "  floor:")),
              HasSubstr("no region `base`: it is held in all examples"));
  EXPECT_THAT(fault(replaced(text, "  grip:", "  top:")),
              AllOf(HasSubstr("example pull does not say on which region it acts"),
                    HasSubstr("region: top or spot")));
  EXPECT_THAT(fault(replaced(text, "radius: 4", "radius: 0.001")),
              AllOf(HasSubstr("recipe.yaml:10:"), HasSubstr("spot")));
  EXPECT_THAT(fault(replaced(text, "texel: 0.2", "image: recipe.yaml")),
              HasSubstr("the surface has no texture coordinates for a picture"));
  EXPECT_THAT(
      fault(text + replaced(kInclusion, "x: 106", "x: 90")),
      AllOf(HasSubstr("stiffness_field.x = 90 is out of range"), HasSubstr("between 100 and 112")));
  EXPECT_THAT(fault(text + replaced(kInclusion, "free ball", "a ball")),
              AllOf(HasSubstr("`stiffness_field` has no variant `a ball` here"),
                    HasSubstr("\"free ball\"")));
  EXPECT_THAT(fault(text + replaced(kInclusion, "a: 1.1", "a: 0")),
              HasSubstr("`stiffness_field` changes nothing with these values"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "capture"));
}

}  // namespace
}  // namespace hookeye
