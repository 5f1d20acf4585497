// Photos made of the model's own pictures leave nothing, whatever is behind the body (told for all
// photos or for one, as a level or as a picture), and a blot on one of them moves next to nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>

#include "estimation/evaluation/photo_evaluation.h"
#include "estimation/fit/fit.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

class OwnPhotos : public testing::Test {
 protected:
  /// Every photo anew: the model's picture, and `behind(x, y)` where the body is not. `tint`: one
  /// channel each, the picture times that.
  template <class Behind>
  void photograph(const Behind& behind, const std::vector<float>& tint = {1.0f}) {
    photograph(small_.scene, behind, tint);
  }
  template <class Behind>
  void photograph(const std::shared_ptr<const Scene>& before, const Behind& behind,
                  const std::vector<float>& tint = {1.0f}) {
    const Scene& scene = *before;
    const ModelForm form = base_form(before);
    const Model model = form.realise(form.initial());
    for (size_t e = 0; e < model.examples.size(); ++e) {
      EquilibriumSolver solver(scene.mesh());
      const auto solved =
          solver.solve(model.energy_of(static_cast<int>(e)), model.examples[e].loading);
      PhotoComparer comparer(before, static_cast<int>(e));
      for (size_t k = 0; k < scene.photos[e].size(); ++k) {
        const Rendering seen = comparer.render(model, solved->q, nullptr, static_cast<int>(k), 0,
                                               render_options(scene));
        Image photo = seen.I;
        for (int y = 0; y < photo.height; ++y)
          for (int x = 0; x < photo.width; ++x)
            photo.at(x, y) += (1.0f - seen.coverage.at(x, y)) * static_cast<float>(behind(x, y));
        fs::path file = scene.capture.examples[e].photos[k].file;
        write_image(file.replace_extension(".exr"), tinted(photo, tint));
      }
    }
  }
  static Image tinted(const Image& grey, const std::vector<float>& tint) {
    Image out{grey.width, grey.height, static_cast<int>(tint.size()), {}};
    for (const float value : grey.values)
      for (const float t : tint) out.values.push_back(t * value);
    return out;
  }
  /// The capture with these photos and `background` for all of them; `more`: a photo's own keys.
  std::shared_ptr<const Scene> told(const std::string& background, const std::string& more = "",
                                    const std::string& texture = "") {
    std::string text = text_of(small_.scene->capture.file);
    text = std::regex_replace(text, std::regex("background: black"), "background: " + background);
    text = std::regex_replace(text, std::regex(R"((photos/\w+)\.png)"),
                              more.empty() ? "$1.exr" : "{file: $1.exr, " + more + "}");
    if (!texture.empty())
      text = std::regex_replace(text, std::regex(R"(texture: \{[^}]*\})"), "texture: " + texture);
    const fs::path file = small_.scene->capture.folder / "told.yaml";
    std::ofstream(file) << text;
    return load_scene(read_capture(file));
  }
  Evaluation seen(const std::shared_ptr<const Scene>& scene) {
    Workspace workspace(scene);
    const ModelForm form = base_form(scene);
    return assess(workspace, form, form.initial()).value().evaluation;
  }
  static double pixels(const Evaluation& evaluation) {
    double count = 0.0;
    for (const auto& example : evaluation.examples)
      for (const auto& photo : example.photos) count += photo.count;
    return count;
  }
  Image empty_scene() const {
    const Camera& camera = small_.scene->capture.cameras.front();
    Image empty{camera.width, camera.height, 1, {}};
    for (int y = 0; y < empty.height; ++y)
      for (int x = 0; x < empty.width; ++x) empty.values.push_back(static_cast<float>(wall(x, y)));
    return empty;
  }
  /// A wall with a pattern.
  static double wall(int x, int y) { return 0.25 + 0.1 * std::sin(0.13 * x) * std::cos(0.11 * y); }

  test::SmallScene small_{{.same_renderer = true}};
};

TEST_F(OwnPhotos, BeforeALevel) {
  photograph([](int, int) { return 0.25; });
  const Evaluation right = seen(told("0.25"));
  EXPECT_LT(right.chi(false), 0.2);
  EXPECT_GT(seen(told("black")).chi(false), 10.0);
  const Evaluation by_photo = seen(told("black", "background: 0.25"));
  EXPECT_LT(by_photo.chi(false), 0.2);
  EXPECT_EQ(pixels(by_photo), pixels(right));
}

TEST_F(OwnPhotos, BeforeAPicture) {
  photograph(wall);
  // Grey levels of eight bits are linear because the photos are said to be.
  write_image(small_.scene->capture.folder / "empty.png", empty_scene(),
              Encoding{Encoding::Kind::linear, 1.0});
  const Evaluation right = seen(told("{photo: empty.png}"));
  EXPECT_LT(right.chi(false), 0.2);
  EXPECT_LT(right.chi(true), 0.2);
  EXPECT_GT(seen(told("0.25")).chi(false), 2.0);
  const Evaluation by_photo = seen(told("ignore", "background: {photo: empty.png}"));
  EXPECT_LT(by_photo.chi(false), 0.2);
  EXPECT_EQ(pixels(by_photo), pixels(right));
  // Pixels at the rim count where the background is told, and no others more.
  const Evaluation ignored = seen(told("ignore"));
  EXPECT_LT(ignored.chi(false), 0.2);
  EXPECT_LT(pixels(ignored), pixels(right));
  EXPECT_GT(pixels(ignored), 0.9 * pixels(right));
}

TEST_F(OwnPhotos, BeforeALevelThatIsFitted) {
  photograph([](int, int) { return 0.25; });
  const auto scene = told("fit");
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto result = fit(workspace, form, form.initial());
  ASSERT_TRUE(result.has_value());
  const Fitted& fitted = *result;
  const auto parameters = form.parameters();
  int levels = 0;
  for (size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].name.starts_with("background.")) {
      EXPECT_NEAR(fitted.p[static_cast<Eigen::Index>(i)], 0.25, 1e-3) << parameters[i].name;
      ++levels;
    }
  EXPECT_EQ(levels, 2);
  EXPECT_LT(fitted.evaluation.chi(false), 0.2);
}

/// A body of one colour, which the fit finds with the modulus: shading and contours tell both.
TEST_F(OwnPhotos, OfABodyOfOneColourThatIsFitted) {
  const auto black = [](int, int) { return 0.0; };
  photograph(black);
  photograph(told("black", "", "{uniform: 0.62}"), black);
  const auto scene = told("black", "", "{uniform: fit}");
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto result = fit(workspace, form, 1.05 * form.initial());
  ASSERT_TRUE(result.has_value());
  const Fitted& fitted = *result;
  const auto parameters = form.parameters();
  const auto albedo = std::find_if(parameters.begin(), parameters.end(),
                                   [](const auto& one) { return one.name == "albedo"; });
  ASSERT_NE(albedo, parameters.end());
  EXPECT_NEAR(fitted.p[albedo - parameters.begin()], 0.62, 1e-3);
  EXPECT_NEAR(fitted.p[0], 0.02, 2e-4);
  EXPECT_LT(fitted.evaluation.chi(false), 0.2);
}

/// Channels of a coloured body, compared one by one with those of its albedo.
TEST_F(OwnPhotos, InColour) {
  const std::vector<float> tint{0.9f, 0.6f, 0.3f};
  photograph([](int, int) { return 0.0; }, tint);
  const fs::path folder = small_.scene->capture.folder;
  const Image albedo = *small_.scene->albedo[0][0];
  write_image(folder / "albedo_rgb.exr", tinted(albedo, tint));
  const std::string texture = "{image: albedo_rgb.exr}";
  const Evaluation luminance = seen(told("black", "", texture));
  EXPECT_LT(luminance.chi(false), 0.2);
  const auto scene = told("black", "channels: rgb", texture);
  const Evaluation by_channel = seen(scene);
  EXPECT_LT(by_channel.chi(false), 0.2);
  EXPECT_EQ(pixels(by_channel), 3.0 * pixels(luminance));
  EXPECT_GT(seen(told("black", "channels: rgb")).chi(false), 2.0) << "a grey albedo";
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto result = fit(workspace, form, 1.2 * form.initial());
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->p[0], 0.02, 2e-5);
}

/// The same photo in three channels says what it said in one: neither interval nor effective number
/// of residuals may count it three times.
TEST_F(OwnPhotos, ChannelsThatRepeatEachOtherCountOnce) {
  const Scene& scene = *small_.scene;
  for (size_t e = 0; e < scene.photos.size(); ++e)
    for (size_t k = 0; k < scene.photos[e].size(); ++k) {
      fs::path file = scene.capture.examples[e].photos[k].file;
      write_image(file.replace_extension(".exr"), tinted(scene.photos[e][k].planes[0], {1, 1, 1}));
    }
  const auto look = [](const std::shared_ptr<const Scene>& at) {
    Workspace workspace(at);
    const ModelForm form = base_form(at);
    const auto fitted = assess(workspace, form, form.initial()).value();
    double effective = 0.0;
    for (const auto& example : fitted.evaluation.examples)
      for (const FlowStatistics& one : photo_statistics(example.photos)) effective += one.effective;
    return Eigen::Vector2d(fitted.high[0] - fitted.low[0], effective);
  };
  const Eigen::Vector2d grey = look(small_.scene), thrice = look(told("black", "channels: rgb"));
  EXPECT_NEAR(thrice[0], grey[0], 0.05 * grey[0]);
  EXPECT_NEAR(thrice[1], grey[1], 0.05 * grey[1]);
}

/// From half a stiffness away, through the coarse sizes: contours pull towards where the photo
/// differs from what is behind the body.
TEST_F(OwnPhotos, AFitBeforeAPicture) {
  photograph(wall);
  write_image(small_.scene->capture.folder / "empty.exr", empty_scene());
  const auto scene = told("{photo: empty.exr}");
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto result = fit(workspace, form, 1.5 * form.initial());
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->p[0], 0.02, 2e-5);
  EXPECT_LT(result->evaluation.chi(false), 0.2);
}

/// Less than eight pixels wide: at an eighth of the size no pixel shows the body alone, and
/// nothing is measured that a fit could go by.
TEST_F(OwnPhotos, AFitOfABodyThatIsThinInThem) {
  const fs::path file = small_.scene->capture.file;
  const std::string text = text_of(file);
  const std::string thin = std::regex_replace(text, std::regex("f([xy]): 950"), "f$1: 80");
  const std::regex measured(R"(\n *measured:[^\n]*(\n *- [^\n]*)*)");
  std::ofstream(file) << std::regex_replace(thin, measured, "");
  photograph(load_scene(read_capture(file)), [](int, int) { return 0.3; });
  const auto scene = told("ignore", "", "{from: rest}");
  for (const auto& example : scene->capture.examples) EXPECT_TRUE(example.measured.empty());
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  EvaluationOptions coarse;
  coarse.level = 3;
  EXPECT_EQ(pixels(workspace.evaluate(form, form.initial(), coarse).value()), 0.0);
  const auto result = fit(workspace, form, 1.2 * form.initial());
  ASSERT_TRUE(result.has_value());
  EXPECT_NEAR(result->p[0], 0.02, 1e-3);
}

/// Robust weights: a strip of one photo shows another motion, as behind a drop of water.
TEST_F(OwnPhotos, AStripThatMovesOtherwiseMovesNoModulus) {
  photograph([](int, int) { return 0.0; });
  const fs::path file = small_.scene->capture.folder / "photos/pull_cam0.exr";
  const Image photo = read_image(file, {});
  Image disturbed = photo;
  const int middle = photo.height / 2;
  for (int y = middle - 15; y < middle + 15; ++y)
    for (int x = 0; x < photo.width; ++x) disturbed.at(x, y) = photo.at(x, y - 5);
  write_image(file, disturbed);
  const auto scene = told("black");
  const auto error = [&](double huber) {
    Workspace workspace(scene);
    const ModelForm form = base_form(scene);
    FitOptions options;
    options.huber = huber;
    const Fitted fitted = fit(workspace, form, 1.1 * form.initial(), options).value();
    return std::abs(fitted.p[0] / 0.02 - 1.0);
  };
  const double robust = error(FitLimits{}.huber), squares = error(0.0);
  EXPECT_LT(robust, 1e-3);
  EXPECT_GT(squares, 5.0 * robust);
}

}  // namespace
}  // namespace hookeye
