#include "capture_io/capture.h"

#include <gtest/gtest.h>

#include "capture_io/camera_text.h"
#include "capture_io/capture_folder.h"
#include "capture_io/yaml_tree.h"
#include "support/shared_data.h"

namespace hookeye::test {
namespace {

Capture read_fixture(const CaptureFixture& fixture) {
  fixture.write();
  return read_capture(fixture.folder());
}

TEST(CaptureTest, HeadBodyAndModel) {
  const CaptureFixture fixture;
  const Capture c = read_fixture(fixture);
  EXPECT_EQ(c.title, "silicone block");
  EXPECT_EQ(c.file, fixture.folder() / "capture.yaml");
  EXPECT_EQ(c.folder, fixture.folder());
  EXPECT_EQ(c.units.stress(), "MPa");
  EXPECT_EQ(c.units.metre(), 1000);
  EXPECT_EQ(c.body.surface, fixture.folder() / "rest.obj");
  EXPECT_TRUE(c.body.volume.empty());
  EXPECT_EQ(c.body.edge, 5);
  EXPECT_EQ(c.body.order, 2);
  EXPECT_TRUE(c.body.mesh_given);
  EXPECT_EQ(c.body.density, 1.07e-9);
  EXPECT_EQ(c.body.texture, BodySpec::Texture::image);
  EXPECT_EQ(c.body.texture_image.path, fixture.folder() / "albedo.png");
  EXPECT_EQ(c.body.texture_encoding->kind, Encoding::Kind::srgb);
  EXPECT_TRUE(c.body.fit_placement);
  EXPECT_FALSE(c.body.flat_shading);
  ASSERT_EQ(c.materials.size(), 1u);
  EXPECT_EQ(c.materials[0].law, "neo-hookean");
  EXPECT_EQ(c.materials[0].parameters.at("mu").numbers, std::vector<double>{0.05});
  EXPECT_EQ(c.materials[0].parameters.at("mu").place.line, 11);
  EXPECT_EQ(c.materials[0].region, "");
  EXPECT_EQ(c.fit, (std::vector<std::string>{"mu", "kappa"}));
  EXPECT_EQ(c.fit_places[1].column, 13);
  EXPECT_EQ(*c.gravity, Vector3d(0, 0, -9810));
}

TEST(CaptureTest, FlatShading) {
  CaptureFixture fixture;
  fixture.replace("  placement: fit", "  shading: flat");
  EXPECT_TRUE(read_fixture(fixture).body.flat_shading);
}

/// Cameras are told in their own frame, and read into the body's.
TEST(CaptureTest, PlacementTakesTheCamerasToTheBody) {
  CaptureFixture fixture;
  const Camera before = read_fixture(fixture).camera("front");
  fixture.replace(
      "  placement: fit",
      "  placement: {rotation: [[0, -1, 0], [1, 0, 0], [0, 0, 1]], translation: [1, 2, 3]}");
  const Capture c = read_fixture(fixture);
  EXPECT_FALSE(c.body.fit_placement);
  const Vector3d in_body(0.5, 0.25, 1), in_cameras(-0.25 + 1, 0.5 + 2, 1 + 3);
  EXPECT_LT(
      (c.camera("front").R * in_body + c.camera("front").t - (before.R * in_cameras + before.t))
          .norm(),
      1e-12);
  EXPECT_EQ(*c.gravity, Vector3d(0, 0, -9810));
  fixture.replace("translation: [1, 2, 3]}", "translation: [1, 2, 3], fit: true}");
  EXPECT_TRUE(read_fixture(fixture).body.fit_placement);
}

TEST(CaptureTest, CamerasAndLight) {
  const CaptureFixture fixture;
  const Capture c = read_fixture(fixture);
  ASSERT_EQ(c.cameras.size(), 3u);
  const Camera& front = c.camera("front");
  EXPECT_EQ(front.width, 8);
  EXPECT_EQ(front.height, 6);
  EXPECT_EQ(front.fx, 11);
  EXPECT_EQ(front.fy, 12);
  EXPECT_EQ(front.distortion, (std::vector<double>{0.1, 0, 0, 0, 0}));
  EXPECT_EQ(front.R.row(1), Eigen::RowVector3d(0, 0, -1));
  EXPECT_EQ(front.t, Vector3d(0, 40, 300));
  EXPECT_EQ(c.camera("left").fx, 20);
  EXPECT_EQ(c.camera("left").t, Vector3d(1, 2, 300));
  EXPECT_EQ(c.camera("top").model->name(), "orthographic");
  EXPECT_EQ(c.camera("top").fy, 2);
  EXPECT_THROW(c.camera("back"), std::out_of_range);
  EXPECT_TRUE(c.light.given);
  EXPECT_EQ(c.light.ambient, 0.4);
  EXPECT_NEAR(c.light.sun.norm(), 0.6, 1e-15);
  EXPECT_LT(c.light.sun.x(), 0);
  EXPECT_TRUE(c.light.uneven.isZero(0.0));
  EXPECT_FALSE(c.light.fit_harmonics);
  const BackgroundSpec& background = c.examples[0].photos[0].background;
  EXPECT_EQ(background.kind, BackgroundSpec::Kind::level);
  EXPECT_EQ(background.level, 0);
}

TEST(CaptureTest, Regions) {
  const Capture c = read_fixture(CaptureFixture());
  ASSERT_EQ(c.regions.size(), 5u);
  EXPECT_EQ(std::get<RegionSpec::Box>(c.region("base")->shape).high, Vector3d(50, 50, 0.1));
  EXPECT_EQ(std::get<RegionSpec::Faces>(c.region("grip")->shape).triangles,
            (std::vector<int>{0, 1, 3}));
  EXPECT_EQ(std::get<RegionSpec::Sphere>(c.region("ball")->shape).radius, 5);
  EXPECT_EQ(std::get<RegionSpec::Halfspace>(c.region("side")->shape).normal, Vector3d(1, 0, 0));
  EXPECT_EQ(std::get<RegionSpec::Group>(c.region("inner")->shape).name, "cavity");
  EXPECT_EQ(c.region("nowhere"), nullptr);
}

TEST(CaptureTest, ExamplesInFileOrder) {
  const Capture c = read_fixture(CaptureFixture());
  ASSERT_EQ(c.examples.size(), 3u);
  EXPECT_EQ(c.examples[0].name, "rest");
  EXPECT_EQ(c.examples[2].name, "held_out");
  EXPECT_TRUE(c.examples[2].validate);
  const ExampleSpec& pull = c.examples[1];
  EXPECT_FALSE(pull.validate);
  ASSERT_EQ(pull.supports.size(), 4u);
  EXPECT_EQ(*pull.supports[0].displacement[2], 0);
  EXPECT_EQ(*pull.supports[1].displacement[1], 0.5);
  EXPECT_FALSE(pull.supports[1].displacement[2]);
  EXPECT_EQ(pull.supports[2].kind, SupportSpec::Kind::rigid);
  EXPECT_EQ(pull.supports[2].rigid.degrees, 20);
  EXPECT_EQ(pull.supports[3].kind, SupportSpec::Kind::rigid_fit);
  EXPECT_EQ(*pull.loads[0].force, Vector3d(0, 0, 2.5));
  EXPECT_EQ(*pull.loads[1].pressure, 0.002);
  ASSERT_EQ(pull.measured.size(), 3u);
  EXPECT_EQ(pull.measured[1].direction, Vector3d(0, 0, 80));
  EXPECT_EQ(pull.measured[2].point, Vector3d(10, 0, 80));
  EXPECT_EQ(pull.measured[2].sigma, Vector3d::Constant(0.1));
}

TEST(CaptureTest, PhotosTakeDefaultsAndOverrideThem) {
  const CaptureFixture fixture;
  const Capture c = read_fixture(fixture);
  const std::vector<PhotoSpec>& photos = c.examples[1].photos;
  ASSERT_EQ(photos.size(), 3u);
  EXPECT_EQ(photos[0].camera, "front");
  EXPECT_EQ(photos[0].encoding->kind, Encoding::Kind::srgb);
  EXPECT_EQ(photos[0].noise->full_well, 20000);
  EXPECT_EQ(photos[0].noise->read, 0.0011);
  EXPECT_EQ(photos[0].background.kind, BackgroundSpec::Kind::level);
  EXPECT_EQ(photos[1].encoding->kind, Encoding::Kind::gamma);
  EXPECT_EQ(photos[1].encoding->gamma, 2.2);
  EXPECT_EQ(photos[1].noise->read, 0.004);
  EXPECT_EQ(photos[1].noise->full_well, 0);
  EXPECT_EQ(photos[1].mask, fixture.folder() / "photos/mask.png");
  EXPECT_EQ(photos[2].kind, PhotoSpec::Kind::silhouette);
  EXPECT_FALSE(photos[2].encoding) << "defaults of photos are not those of masks";
  EXPECT_FALSE(photos[2].noise);
}

TEST(CaptureTest, BackgroundsAndTextures) {
  using Kind = BackgroundSpec::Kind;
  for (const auto& [text, kind, level] : std::vector<std::tuple<std::string, Kind, double>>{
           {"ignore", Kind::ignore, 0},
           {"fit", Kind::fit, 0},
           {"0.25", Kind::level, 0.25},
           {"{photo: photos/rest.png}", Kind::photo, 0}}) {
    CaptureFixture fixture;
    fixture.replace("background: black", "background: " + text);
    const Capture c = read_fixture(fixture);
    EXPECT_EQ(c.examples[0].photos[0].background.kind, kind) << text;
    EXPECT_EQ(c.examples[0].photos[0].background.level, level) << text;
  }
  CaptureFixture from, uniform, fitted;
  from.replace("{image: albedo.png, encoding: srgb}", "{from: rest}");
  EXPECT_EQ(read_fixture(from).body.texture_example, "rest");
  uniform.replace("{image: albedo.png, encoding: srgb}", "{uniform: 0.5}");
  EXPECT_EQ(*read_fixture(uniform).body.uniform_albedo, 0.5);
  fitted.replace("{image: albedo.png, encoding: srgb}", "{uniform: fit}");
  EXPECT_FALSE(read_fixture(fitted).body.uniform_albedo);
}

TEST(CaptureTest, LawsByRegionAndNestedNumbers) {
  CaptureFixture fixture;
  fixture.write_file("rest.msh", "");
  fixture.replace("surface: rest.obj", "surface: rest.obj\n  volume: rest.msh");
  fixture.replace("{law: neo-hookean, mu: 0.05, kappa: 0.5}",
                  "{core: {law: ogden, mu: [1, 2], alpha: [3, -4], kappa: 9},\n"
                  "    shell: {law: additive, e11: {values: [[1, 2], [3, 4]]}}}");
  const Capture c = read_fixture(fixture);
  ASSERT_EQ(c.materials.size(), 2u);
  EXPECT_EQ(c.materials[0].region, "core");
  EXPECT_EQ(c.materials[0].parameters.at("alpha").numbers, (std::vector<double>{3, -4}));
  EXPECT_EQ(c.materials[1].region, "shell");
  EXPECT_EQ(c.materials[1].parameters.at("e11.values").numbers, (std::vector<double>{1, 2, 3, 4}));
}

TEST(CaptureTest, LawsBlendedOverTheBody) {
  CaptureFixture fixture;
  fixture.replace(
      "{law: neo-hookean, mu: 0.05, kappa: 0.5}",
      "{foot: {law: stvk, mu: 1, lambda: 1, blend: {along: [0, 0, 2], at: [0, 4, 6], weight: [1, "
      "0.5, 0]}},\n    head: {law: stvk, mu: 2, lambda: 1, blend: {along: [0, 0, 1], at: [0, 6], "
      "weight: [0, 1]}}}");
  fixture.replace("fit: [mu, kappa]", "fit: [foot.mu, head.mu]");
  const Capture c = read_fixture(fixture);
  ASSERT_EQ(c.materials.size(), 2u);
  const auto& blend = *c.materials[0].blend;
  EXPECT_EQ(blend.of({7, 8, -1}), 1.0);
  EXPECT_EQ(blend.of({7, 8, 2}), 0.75);
  EXPECT_EQ(blend.of({0, 0, 5}), 0.25);
  EXPECT_EQ(blend.of({0, 0, 6}), 0.0);
  EXPECT_EQ(c.materials[1].region, "head");
}

TEST(CaptureTest, LightOfHarmonics) {
  CaptureFixture fixture;
  fixture.replace("ambient: 0.4", "harmonics: [2, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, -0.8]");
  const LightSpec told = read_fixture(fixture).light;
  EXPECT_TRUE(told.given);
  EXPECT_NEAR(told.ambient, 2 / std::sqrt(4 * M_PI), 1e-15);
  EXPECT_EQ(told.uneven[0], 0.1);
  EXPECT_EQ(told.uneven[7], -0.8);
  EXPECT_NEAR(told.sun.norm(), 0.6, 1e-15);
  CaptureFixture open;
  open.replace("ambient: 0.4", "harmonics: fit");
  const LightSpec fitted = read_fixture(open).light;
  EXPECT_FALSE(fitted.given);
  EXPECT_TRUE(fitted.fit_harmonics);
  EXPECT_NEAR(fitted.sun.norm(), 0.6, 1e-15);
}

TEST(CaptureTest, LensesAreToldOrFitted) {
  CaptureFixture fixture;
  fixture.replace("left: {calibration: left.yml}",
                  "left: {calibration: left.yml, vignetting: 1.5, chromatic_shift: {red: 1.001}}");
  fixture.write_grey("photos/colours.png", 8, 6, 0.5f, 3);
  fixture.replace("left: photos/rest.png}", "left: {file: photos/colours.png, channels: rgb}}");
  const Camera told = read_fixture(fixture).camera("left");
  EXPECT_EQ(told.vignetting, 1.5);
  EXPECT_NEAR(told.colour_zoom[0], std::log(1.001), 1e-15);
  EXPECT_EQ(told.colour_zoom[1], 0.0);
  EXPECT_FALSE(told.fit_vignetting || told.fit_colour_zoom);
  EXPECT_NEAR(told.of_colour(0).fx, 1.001 * told.fx, 1e-12);
  EXPECT_EQ(told.of_colour(1).fx, told.fx);
  CaptureFixture again;
  again.replace("  left: {calibration: left.yml}\n", camera_text(told));
  again.write_grey("photos/colours.png", 8, 6, 0.5f, 3);
  again.replace("left: photos/rest.png}", "left: {file: photos/colours.png, channels: rgb}}");
  const Camera written = read_fixture(again).camera("left");
  EXPECT_EQ(written.vignetting, 1.5);
  EXPECT_NEAR(written.colour_zoom[0], told.colour_zoom[0], 1e-15);

  CaptureFixture open;
  open.replace("left: {calibration: left.yml}",
               "left: {calibration: left.yml, vignetting: fit, chromatic_shift: fit}");
  open.write_grey("photos/colours.png", 8, 6, 0.5f, 3);
  open.replace("left: photos/rest.png}", "left: {file: photos/colours.png, channels: rgb}}");
  const Camera fitted = read_fixture(open).camera("left");
  EXPECT_TRUE(fitted.fit_vignetting && fitted.fit_colour_zoom);
  EXPECT_NE(camera_text(fitted).find("    vignetting: fit\n    chromatic_shift: fit\n"),
            std::string::npos);
}

TEST(CaptureTest, SimulationNeedsNoPictures) {
  CaptureFixture fixture;
  fixture.yaml =
      "hookeye: 1\nunits: {length: m, force: N}\nbody: {surface: rest.obj}\n"
      "model: {material: {law: stvk, lambda: 1, mu: 2}}\nregions: {a: {group: x}}\n"
      "examples: {pull: {supports: [{region: a, fix: [x]}]}}\n";
  const Capture c = read_fixture(fixture);
  EXPECT_TRUE(c.cameras.empty());
  EXPECT_FALSE(c.light.given);
  EXPECT_FALSE(c.gravity);
  EXPECT_EQ(c.units.stress(), "Pa");
  EXPECT_EQ(c.units.metre(), 1);
}

TEST(CaptureTest, RigidMotionTurnsAboutItsCentre) {
  RigidMotion motion;
  motion.degrees = 90;
  motion.center = {1, 0, 0};
  motion.move = {0, 0, 5};
  EXPECT_TRUE(motion.apply({2, 0, 0}).isApprox(Vector3d(1, 1, 5)));
}

TEST(CaptureTest, AliasesAreValuesToo) {
  CaptureFixture fixture;
  fixture.replace("- {region: base, fix: [x, y, z]}", "- &held {region: base, fix: [x, y, z]}");
  fixture.replace("- {region: base, fix: [z]}", "- *held");
  EXPECT_EQ(*read_fixture(fixture).examples[2].supports[0].displacement[1], 0);
}

/// Whatever the end of a file is, it reads or is refused: no crash, no other exception.
TEST(CaptureTest, EveryTruncationIsReadOrRefused) {
  CaptureFixture fixture;
  const std::string whole = fixture.yaml;
  size_t read = 0, refused = 0;
  for (size_t length = 0; length < whole.size(); ++length) {
    fixture.yaml = whole.substr(0, length);
    fixture.write();
    try {
      read_capture(fixture.folder());
      ++read;
    } catch (const InputError& error) {
      EXPECT_FALSE(error.wrong().empty());
      EXPECT_FALSE(error.place().file.empty());
      ++refused;
    }
  }
  EXPECT_GT(read, 5u);
  EXPECT_GT(refused, 1000u);
}

/// One byte replaced: the parser sees every kind of junk at every place.
TEST(CaptureTest, EveryDamagedByteIsReadOrRefused) {
  const CaptureFixture fixture;
  for (const char junk : {'\0', '\t', '[', '}', ':', '*', '&', '\'', '"', '\xff', '-', '|', '!'}) {
    for (size_t i = 0; i < fixture.yaml.size(); i += 3) {
      std::string text = fixture.yaml;
      text[i] = junk;
      try {
        parse_yaml(text, "capture.yaml");
      } catch (const InputError& error) {
        EXPECT_FALSE(error.wrong().empty());
      }
    }
  }
}

TEST(CaptureTest, CapturesOfOthersAreRead) {
  HOOKEYE_NEEDS_DATA("hidden");
  size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(shared_data() / "hidden")) {
    if (!std::filesystem::exists(entry.path() / "capture.yaml")) continue;
    const Capture c = read_capture(entry.path());
    EXPECT_EQ(c.cameras.size(), 2u);
    ASSERT_EQ(c.examples.size(), 7u);
    EXPECT_EQ(c.examples[0].name, "rest");
    EXPECT_EQ(c.examples[3].name, "twist");
    EXPECT_EQ(c.examples[3].supports[1].kind, SupportSpec::Kind::rigid);
    EXPECT_TRUE(c.examples[6].validate);
    EXPECT_EQ(c.examples[1].photos.size(), 2u);
    EXPECT_EQ(c.examples[1].photos[0].noise->full_well, 20000);
    ++count;
  }
  EXPECT_EQ(count, 6u);
}

}  // namespace
}  // namespace hookeye::test
