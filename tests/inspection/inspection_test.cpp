// What `check` sees: every ordinary mistake is told of by its name, and a right capture is not.
#include "estimation/inspection/inspection.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <regex>

#include "estimation/inspection/flip.h"
#include "inspection/inspected_capture.h"

namespace hookeye::test {
namespace {

using inspection::Turn;
using inspection::turned;
using testing::HasSubstr;

/// The same of every capture that is right.
void expect_quiet(const Inspection& seen) {
  EXPECT_EQ(said(seen), "");
  ASSERT_EQ(seen.cameras.size(), 2U);
  for (const PhotoLook& look : seen.cameras) {
    EXPECT_GT(look.overlap, 0.95);
    EXPECT_GT(look.share, 0.9);
    EXPECT_LT(look.shift_px, 0.5);
  }
}

TEST(Inspection, ARightCaptureIsLeftInPeace) {
  const InspectedCapture capture;
  const Inspection seen = capture.inspect();
  expect_quiet(seen);
  for (const PhotoLook& look : seen.cameras) EXPECT_GT(look.correlation, 0.9);
  ASSERT_EQ(seen.guesses.size(), 6U);
  for (const GuessLook& guess : seen.guesses) EXPECT_FALSE(std::isnan(guess.displacement));
}

TEST(Inspection, SilhouettesAreToldWithoutATexture) {
  InspectedCapture capture;
  capture.change("texture: \\{image[^}]*\\}", "texture: {uniform: 0.5}");
  const Inspection seen = capture.inspect({.first_guess = false});
  EXPECT_EQ(said(seen), "");
  for (const PhotoLook& look : seen.cameras) {
    EXPECT_GT(look.overlap, 0.95);
    EXPECT_TRUE(std::isnan(look.share));
    EXPECT_NE(look.no_correlation, "");
  }
}

/// To first order half a turn strains a body by several times; it is a turn all the same.
TEST(Inspection, ALargeTurnIsNoWrongUnit) {
  InspectedCapture capture;
  capture.change("texture: \\{image[^}]*\\}", "texture: {uniform: 0.5}");
  capture.change("degrees: [0-9.]+", "degrees: 170");
  const Inspection seen = capture.inspect();
  EXPECT_THAT(said(seen), testing::Not(HasSubstr("strain the body")));
  const Capture told = read_capture(capture.folder());
  const auto twist = std::find_if(
      seen.guesses.begin(), seen.guesses.end(),
      [&](const GuessLook& guess) { return told.examples.at(guess.example).name == "twist"; });
  ASSERT_NE(twist, seen.guesses.end());
  EXPECT_FALSE(std::isnan(twist->displacement)) << twist->failure;
}

TEST(Inspection, DrawsTheBodyOverEveryPhoto) {
  const InspectedCapture capture;
  const auto scene = load_scene(read_capture(capture.folder()));
  const TemporaryFolder out;
  const Inspection seen = inspect(*scene, {}, out / "look");
  EXPECT_TRUE(std::filesystem::exists(seen.sheet));
  ASSERT_EQ(seen.photos.size(), 12U);
  for (const PhotoLook& look : seen.photos) {
    const Image picture = read_image(look.picture, Encoding{});
    EXPECT_EQ(picture.width, 400);
    EXPECT_EQ(picture.channels, 3);
    // The model's outline is orange: there is as much of it as the body has circumference.
    int orange = 0;
    for (size_t i = 0; i < picture.pixels(); ++i)
      orange += picture.values[3 * i] > 0.95f && picture.values[3 * i + 2] < 0.1f;
    EXPECT_GT(orange, 500) << look.picture;
  }
}

TEST(Inspection, TellsHowFarItIs) {
  const InspectedCapture capture;
  const auto scene = load_scene_to_look_at(read_capture(capture.folder()), 640);
  std::mutex mutex;
  std::map<std::string, std::pair<int, int>> most;
  const auto count = [&](const char* what) {
    return [&, what](int done, int of) {
      const std::lock_guard lock(mutex);
      most[what] = std::max(most[what], {done, of});
    };
  };
  inspect(*scene, {}, {}, {count("solved"), count("looked"), count("compared")});
  EXPECT_EQ(most, (std::map<std::string, std::pair<int, int>>{
                      {"compared", {6, 6}}, {"looked", {12, 12}}, {"solved", {6, 6}}}));
}

TEST(Inspection, PhotosOfACameraShareWhatCounts) {
  const InspectedCapture capture;
  const auto scene = load_scene_to_look_at(read_capture(capture.folder()), 100);
  for (const auto& photos : scene->photos)
    EXPECT_EQ(photos.at(0).valid.pointer(), scene->photos[0][0].valid.pointer());
}

/// What the inspection of these photos ends with once something was done to one of them.
std::string ended_by(const std::function<void(const std::filesystem::path& photo)>& change) {
  const InspectedCapture capture;
  const auto scene = load_scene_to_look_at(read_capture(capture.folder()), 640);
  change(capture.folder() / "photos/press_cam0.png");
  try {
    inspect(*scene, {.first_guess = false});
  } catch (const InputError& error) {
    EXPECT_GT(error.place().line, 0);
    return error.what();
  }
  return "";
}

TEST(Inspection, PhotosThatGoOrChangeMeanwhileAreNamed) {
  EXPECT_THAT(ended_by([](const auto& photo) { std::filesystem::remove(photo); }),
              HasSubstr("press_cam0.png: there is no such file"));
  EXPECT_THAT(ended_by([](const auto& photo) {
                std::filesystem::copy_file(photo.parent_path() / "pull_cam0.png", photo,
                                           std::filesystem::copy_options::overwrite_existing);
              }),
              HasSubstr("press_cam0.png has changed since it was read"));
}

/// A camera that was knocked between its photos moves all of a picture: no load is blamed for it.
TEST(Inspection, AMovedCameraIsNoWrongLoad) {
  const InspectedCapture capture;
  for (const char* photo : {"photos/side_cam0.png", "photos/side_cam1.png"}) {
    const auto file = capture.folder() / photo;
    const Image image = read_image(file, Encoding{});
    Image moved = image;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        moved.values[static_cast<size_t>(y * image.width + x)] = image.at(std::max(x - 40, 0), y);
    write_image(file, moved);
  }
  const Inspection seen = capture.inspect();
  const auto side = std::find_if(seen.guesses.begin(), seen.guesses.end(), [](const auto& guess) {
    return guess.example == 2 && std::abs(guess.cosine) < 0.5;
  });
  EXPECT_NE(side, seen.guesses.end()) << "the motion is another than expected";
  EXPECT_THAT(said(seen), testing::Not(HasSubstr("not where the capture would move it")));
}

struct Slip {
  const char* name;
  void (*make)(InspectedCapture& capture);
  const char* question;
  const char* seen;  ///< part of the warning
};

void PrintTo(const Slip& slip, std::ostream* out) { *out << slip.name; }

class Slips : public testing::TestWithParam<Slip> {};

TEST_P(Slips, IsToldByItsName) {
  InspectedCapture capture;
  GetParam().make(capture);
  const Inspection seen = capture.inspect();
  ASSERT_FALSE(seen.warnings.empty());
  const auto told = std::find_if(
      seen.warnings.begin(), seen.warnings.end(),
      [](const CaptureWarning& warning) { return warning.question == GetParam().question; });
  ASSERT_NE(told, seen.warnings.end()) << said(seen);
  EXPECT_THAT(told->text(), HasSubstr(GetParam().seen));
  EXPECT_GT(told->place.line, 0);
  EXPECT_THAT(told->place.file, HasSubstr("capture.yaml"));
}

template <Turn turn>
void turn_photos(InspectedCapture& capture) {
  capture.change_photos([](const Image& image) { return turned(image, turn); });
}

/// A regular expression of what stands in example `name` up to `until`.
std::string in(const std::string& name, const std::string& until) {
  return "(\n  " + name + ":\n[^#]*?" + until + ")";
}

/// Every pose as `f` makes it.
void change_poses(InspectedCapture& capture, const std::function<void(Camera&)>& f) {
  const auto cameras = read_capture(capture.folder()).cameras;
  const std::string now = capture.text();
  const std::regex pattern(
      R"(rotation: \[\[[^\]]*\], \[[^\]]*\], \[[^\]]*\]\]\s+translation: \[[^\]]*\])");
  std::string out;
  auto from = now.begin();
  size_t k = 0;
  for (std::sregex_iterator at(now.begin(), now.end(), pattern), end; at != end; ++at) {
    Camera camera = cameras.at(k++);
    f(camera);
    out.append(from, now.begin() + at->position());
    out += "rotation: [";
    for (int i = 0; i < 3; ++i)
      out += fmt::format("{}[{}, {}, {}]", i ? ", " : "", camera.R(i, 0), camera.R(i, 1),
                         camera.R(i, 2));
    out += fmt::format("]\n      translation: [{}, {}, {}]", camera.t[0], camera.t[1], camera.t[2]);
    from = now.begin() + at->position() + at->length();
  }
  ASSERT_EQ(k, cameras.size());
  out.append(from, now.end());
  std::ofstream(capture.folder() / "capture.yaml") << out;
}

/// What Blender calls matrix_world: camera to world, y up, z backwards.
void to_world_by_opengl(Camera& c) {
  const Eigen::Matrix3d R = c.R.transpose();
  c.t = -R * c.t;
  c.R = R * Eigen::Vector3d(1, -1, -1).asDiagonal();
}

double to_srgb(double l) {
  return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1.0 / 2.4) - 0.055;
}

const Slip kSlips[] = {
    {"PosesInMetres",
     [](InspectedCapture& c) {
       c.change_numbers("translation", [](double t) { return t / 1000; });
     },
     "flips", "the translation is 1000 times as long"},
    {"RotationsTransposed",
     [](InspectedCapture& c) {
       change_poses(c, [](Camera& camera) { camera.R.transposeInPlace(); });
     },
     "flips", "the rotation is transposed"},
    {"RotationsTransposedAndMetres",
     [](InspectedCapture& c) {
       change_poses(c, [](Camera& camera) { camera.R.transposeInPlace(), camera.t /= 1000; });
     },
     "flips", "the rotation is transposed and its lengths are 1000 times as long"},
    {"PosesOfBlenderInMetres",
     [](InspectedCapture& c) {
       change_poses(c, [](Camera& camera) {
         to_world_by_opengl(camera);
         camera.t /= 1000;
       });
     },
     "flips", "(Blender's matrix_world) and its lengths are 1000 times as long"},
    {"CameraToWorldInMillimetresForMetres",
     [](InspectedCapture& c) {
       change_poses(c, [](Camera& camera) {
         camera.R.transposeInPlace();
         camera.t = -1000 * (camera.R * camera.t);
       });
     },
     "flips", "the pose maps camera to world and its lengths are a thousandth as long"},
    {"RadiansForDegrees",
     [](InspectedCapture& c) { c.change("degrees: [0-9.]+", "degrees: 0.4189"); }, "magnitudes",
     "(radians for degrees?)"},
    {"RadiansByTheirDigits",
     [](InspectedCapture& c) { c.change("degrees: [0-9.]+", "degrees: 0.4363"); }, "angles",
     "as radians it would be 25 degrees"},
    {"PhotosUpsideDown", turn_photos<Turn::half>, "flips", "the photo is turned by 180 degrees"},
    {"PhotosMirrored", turn_photos<Turn::mirrored>, "flips", "the photo is mirrored left to right"},
    {"CamerasSwapped",
     [](InspectedCapture& c) {
       c.change("_cam0\\.png", "_other.png");
       c.change("_cam1\\.png", "_cam0.png");
       c.change("_other\\.png", "_cam1.png");
     },
     "flips", "stands here"},
    {"CamerasSwappedWhosePhotosAreTheTexture",
     [](InspectedCapture& c) {
       c.change("texture: \\{image[^}]*\\}", "texture: {from: rest}");
       c.change("_cam0\\.png", "_other.png");
       c.change("_cam1\\.png", "_cam0.png");
       c.change("_other\\.png", "_cam1.png");
     },
     "flips", "does not see the body where its photo of example `rest` shows it"},
    {"ACameraThatStandsBesideItsPose",
     [](InspectedCapture& c) {
       c.change("texture: \\{image[^}]*\\}", "texture: {from: rest}");
       c.change("cx: 199.5", "cx: 225.5");
     },
     "flips", "px off)"},
    {"IntrinsicsOfTwiceTheSize",
     [](InspectedCapture& c) {
       c.change("fx: 2100, fy: 2100, cx: 199.5, cy: 239.5",
                "fx: 4200, fy: 4200, cx: 399.5, cy: 479.5");
     },
     "flips", "fx, fy, cx and cy are halved"},
    {"PhotoOfAnotherLoadCase",
     [](InspectedCapture& c) {
       c.change("photos/pull_cam0", "photos/other");
       c.change("photos/twist_cam0", "photos/pull_cam0");
       c.change("photos/other", "photos/twist_cam0");
     },
     "exchanges", "shows the motion of example `twist`"},
    {"TheSamePhotoTwice",
     [](InspectedCapture& c) { c.change("photos/pull_cam1", "photos/pull_cam0"); }, "equal_photos",
     "has the very pixels of photo `cam0` of example `pull`"},
    {"NoRestPhoto", [](InspectedCapture& c) { c.change("\n  rest:\n(    .*\n)+", "\n"); },
     "rest_photos", "no photo shows the body at rest"},
    {"DistortionOfUndistortedPhotos",
     [](InspectedCapture& c) {
       c.change("cy: 239.5\\}", "cy: 239.5, distortion: [-0.4, 0, 0, 0, 0]}");
     },
     "distortion", "px without"},
    {"SrgbToldAsLinear",
     [](InspectedCapture& c) {
       c.change_photos([](Image image) {
         for (float& v : image.values) v = static_cast<float>(to_srgb(v));
         return image;
       });
     },
     "encoding", "read as linear"},
    {"LinearLeftOut", [](InspectedCapture& c) { c.change("\n  encoding: linear", ""); }, "encoding",
     "read as linear their bright and dark speckles fit"},
    {"TwelveBitsInSixteen",
     [](InspectedCapture& c) {
       c.change_photos(
           [](Image image) {
             for (float& v : image.values) v *= 4095.0f / 65535.0f;
             return image;
           },
           16);
     },
     "photo_range", "12 bits stored in 16"},
    {"HalfOfARegion",
     [](InspectedCapture& c) { c.change("(box: \\[\\[[^\\]]*\\], )\\[[^,]*,", "$1[0,"); },
     "directions", "`base` reaches over the whole of its flat face"},
    {"LoadReversed", [](InspectedCapture& c) { c.change(in("pull", "force: \\[0, 0, "), "$1-"); },
     "directions", "the force on `grip` has the other sign"},
    {"ForceInTheAxesOfThePart",
     [](InspectedCapture& c) {
       c.change(in("side", "force: \\[") + "([-0-9.e]+), ([-0-9.e]+)", "$1-$3, $2");
     },
     "directions", "not where the capture would move it"},
    {"LoadOnWhatIsHeld",
     [](InspectedCapture& c) { c.change("region: grip, force", "region: base, force"); },
     "idle_keys", "hold all of region `base`"},
    {"LightOfALitTexture",
     [](InspectedCapture& c) { c.change("texture: \\{image[^}]*\\}", "texture: {from: rest}"); },
     "idle_keys", "the light changes nothing"},
    {"KilonewtonsForNewtons",
     [](InspectedCapture& c) { c.change_numbers("force", [](double f) { return f / 1000; }); },
     "magnitudes", "kN for N"},
    {"GramsForNewtons",
     [](InspectedCapture& c) { c.change_numbers("force", [](double f) { return f * 102; }); },
     "magnitudes", "grams for N"},
    {"SignOfATwist", [](InspectedCapture& c) { c.change("degrees: ", "degrees: -"); }, "directions",
     "the rotation of `grip` has the other sign"},
    {"SignOfAPress", [](InspectedCapture& c) { c.change("move: \\[0, 0, -", "move: [0, 0, "); },
     "directions", "the motion of `grip` has the other sign"},
    {"MetresForMillimetres",
     [](InspectedCapture& c) { c.change("units: .*", "units: {length: m, force: N}"); }, "sizes",
     "`units: {length: mm, force: N}`, in which the body is 4"},
    {"PascalsWithMillimetres",
     [](InspectedCapture& c) { c.change(", mu: [0-9.]+", ", mu: 17000"); }, "sizes",
     "its shear modulus 17 GPa"},
    {"DensityInSiWithMillimetres",
     [](InspectedCapture& c) { c.change("density: .*", "density: 1070"); }, "weights",
     "1.07e+15 kg/m^3"},
    {"ModulusInAnotherUnit", [](InspectedCapture& c) { c.change(", mu: [0-9.]+", ", mu: 40000"); },
     "magnitudes", "moduli lower"},
};

INSTANTIATE_TEST_SUITE_P(Inspection, Slips, testing::ValuesIn(kSlips),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace hookeye::test
