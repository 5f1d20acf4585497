// Texture from a rest photo (ordinary speckle practice) on pictures whose motion is known exactly.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "estimation/effects/catalogue.h"
#include "estimation/evaluation/normal_equations.h"
#include "estimation/fit/fit.h"
#include "estimation/model/effect.h"
#include "support/derivative.h"
#include "support/temporary_folder.h"

namespace hookeye {
namespace {

constexpr int kSize = 160;
constexpr double kScale = 4.0;  // px/mm; the block's face is 30 mm, 120 px
constexpr float kNoise = 0.004f;

/// Speckle of some four pixels, band-limited: waves of 3.5 px and longer.
class Speckle {
 public:
  Speckle() {
    std::mt19937 engine(7);
    std::uniform_real_distribution<double> angle(0.0, 2.0 * M_PI), length(3.5, 12.0);
    for (int i = 0; i < 60; ++i) {
      const double a = angle(engine), k = 2.0 * M_PI / length(engine);
      waves_.push_back({k * std::cos(a), k * std::sin(a), angle(engine)});
    }
  }
  /// Through a lens that blurs by the variance `blur` [px^2].
  double at(double x, double y, double blur) const {
    double sum = 0.0;
    for (const auto& w : waves_)
      sum += std::exp(-blur * (2.0 - std::cos(w[0]) - std::cos(w[1]))) *
             std::cos(w[0] * x + w[1] * y + w[2]);
    return 0.4 + 0.15 * sum / std::sqrt(waves_.size() / 2.0);
  }

 private:
  std::vector<std::array<double, 3>> waves_;
};

/// Photo whose pixel (x, y) shows what the rest photo has at from(x, y), with noise.
void write_photo(
    const std::filesystem::path& file, unsigned seed,
    const std::function<Eigen::Vector2d(double, double)>& from,
    const std::function<double(double, double)>& gain = [](double, double) { return 1.0; },
    double blur = 0.0) {
  static const Speckle speckle;
  std::mt19937 engine(seed);
  std::normal_distribution<float> noise(0.0f, kNoise);
  Image image{kSize, kSize, 1, std::vector<float>(kSize * kSize)};
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const Eigen::Vector2d at = from(x, y);
      image.at(x, y) =
          static_cast<float>(gain(x, y) * speckle.at(at.x(), at.y(), blur)) + noise(engine);
    }
  write_image(file, image);
}

/// Block 30 x 30 x 6 mm before an orthographic camera; in `moved` its bottom goes along `bottom`.
/// `keys`: more keys of the body.
std::shared_ptr<const Scene> block_scene(const test::TemporaryFolder& folder,
                                         const std::string& bottom, const std::string& keys = "") {
  std::ofstream(folder / "block.obj") << R"(v -15 -15 0
v 15 -15 0
v 15 15 0
v -15 15 0
v -15 -15 -6
v 15 -15 -6
v 15 15 -6
v -15 15 -6
f 1 2 3
f 1 3 4
f 5 7 6
f 5 8 7
f 1 5 6
f 1 6 2
f 2 6 7
f 2 7 3
f 3 7 8
f 3 8 4
f 4 8 5
f 4 5 1
)";
  std::ofstream(folder / "capture.yaml") << fmt::format(
      R"(hookeye: 1
units: {{length: mm, force: N}}
body: {{surface: block.obj, mesh: {{edge: 8, order: 2}}, texture: {{from: rest}}{4}}}
model: {{material: {{law: neo-hookean, mu: 1, kappa: 1}}}}
cameras:
  front:
    size: [{0}, {0}]
    projection: orthographic
    intrinsics: {{scale: {1}, cx: 79.5, cy: 79.5}}
    pose: {{rotation: [[1, 0, 0], [0, -1, 0], [0, 0, -1]], translation: [0, 0, 100]}}
photos: {{encoding: linear, noise: {2}}}
regions:
  bottom: {{halfspace: {{point: [0, -14.99, 0], normal: [0, -1, 0]}}}}
  top: {{halfspace: {{point: [0, 14.99, 0], normal: [0, 1, 0]}}}}
examples:
  rest: {{supports: [{{region: bottom, fix: [x, y, z]}}], photos: {{front: rest.tif}}}}
  moved:
    supports: [{{region: bottom, rigid: {3}}}]
    photos: {{front: {{file: moved.tif{5}}}}}
)",
      kSize, kScale, kNoise, bottom, keys,
      std::filesystem::exists(folder / "mask.png") ? ", mask: mask.png" : "");
  return load_scene(read_capture(folder.path()));
}

Fitted seen(std::shared_ptr<const Scene> scene) {
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  auto result = assess(workspace, form, form.initial());
  if (!result) throw std::runtime_error(result.error().reason);
  return *std::move(result);
}

/// Moved by fractions of a pixel, the model's picture of a moved body is the moved photo: nothing
/// but noise is left. The filter that a rendered body needs would blur it a second time.
TEST(RestTexture, MovedBodyLeavesOnlyNoise) {
  const test::TemporaryFolder folder;
  const Eigen::Vector2d u_px(2.3, -1.55);
  write_photo(folder / "rest.tif", 1, [](double x, double y) { return Eigen::Vector2d(x, y); });
  write_photo(folder / "moved.tif", 2,
              [&](double x, double y) { return Eigen::Vector2d(Eigen::Vector2d(x, y) - u_px); });
  const Fitted fitted = seen(block_scene(
      folder, fmt::format("{{move: [{}, {}, 0]}}", u_px.x() / kScale, -u_px.y() / kScale)));
  const auto& photos = fitted.evaluation.find(1)->photos;
  ASSERT_EQ(photos.size(), 1u);
  EXPECT_GT(photos[0].count, 0.9 * 120 * 120);
  // Interpolation takes up to a third off the reference photo's noise.
  EXPECT_GT(photos[0].chi(), 0.83);
  EXPECT_LT(photos[0].chi(), 1.03);
  EXPECT_LT(photos[0].flow.rms_px(), 0.01);
}

/// A motion that the model lacks comes out as the residual displacement, at its full length. Waves
/// of 7 px and longer: finer ones bend within the motion.
TEST(RestTexture, LackingMotionIsTheResidualDisplacement) {
  const test::TemporaryFolder folder;
  const Eigen::Vector2d u_px(0.31, -0.22);
  write_photo(folder / "rest.tif", 1,
              [](double x, double y) { return Eigen::Vector2d(x / 2.0, y / 2.0); });
  write_photo(folder / "moved.tif", 2, [&](double x, double y) {
    return Eigen::Vector2d((Eigen::Vector2d(x, y) - u_px) / 2.0);
  });
  const Fitted fitted = seen(block_scene(folder, "{move: [0, 0, 0]}"));
  const FlowField& flow = fitted.evaluation.find(1)->photos.at(0).flow;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  int cells = 0;
  for (const auto& cell : flow.cells)
    if (cell.reliable) mean += cell.estimate.head<2>(), ++cells;
  ASSERT_GT(cells, 30);
  EXPECT_LT((mean / cells - u_px).norm(), 0.01) << (mean / cells).transpose();
}

/// Pixels far from every rim, so that the same ones count in all neighbours of a difference.
void write_middle_mask(const std::filesystem::path& file) {
  Image mask{kSize, kSize, 1, std::vector<float>(kSize * kSize, 0.0f)};
  for (int y = 50; y < 110; ++y)
    for (int x = 50; x < 110; ++x) mask.at(x, y) = 1.0f;
  write_image(file, mask);
}

/// A body that was turned by less than its photo shows, so that every slope is there.
std::shared_ptr<const Scene> turned_scene(const test::TemporaryFolder& folder,
                                          const std::string& keys = "") {
  write_photo(folder / "rest.tif", 1, [](double x, double y) { return Eigen::Vector2d(x, y); });
  write_photo(folder / "moved.tif", 2,
              [](double x, double y) { return Eigen::Vector2d(x - 2.2 + 0.01 * y, y + 1.5); });
  write_middle_mask(folder / "mask.png");
  return block_scene(
      folder, "{rotate: {axis: [1, 2, 6], degrees: 8, center: [0, 0, 0]}, move: [0.5, -0.4, 1]}",
      keys);
}

/// The same scene, where the model's picture does not follow the photo's brightness.
std::shared_ptr<Scene> as_it_was(const Scene& scene) {
  auto limits = std::make_shared<Limits>();
  set_limit(*limits, "fit.brightness_cell", 0.0, "test");
  auto out = std::make_shared<Scene>(scene);
  out->limits = limits;
  return out;
}

/// A lamp that the body turned in makes its face brighter, more so on one side: the model's picture
/// follows, and what is left is noise.
TEST(RestTexture, ShadingThatChangedIsFollowed) {
  const test::TemporaryFolder folder;
  write_photo(folder / "rest.tif", 1, [](double x, double y) { return Eigen::Vector2d(x, y); });
  write_photo(
      folder / "moved.tif", 2, [](double x, double y) { return Eigen::Vector2d(x - 2.0, y); },
      [](double x, double) { return 0.8 + 0.002 * x; });
  const auto scene = block_scene(folder, "{move: [0.5, 0, 0]}");
  const Fitted fitted = seen(scene);
  const PhotoEvaluation& photo = fitted.evaluation.find(1)->photos.at(0);
  EXPECT_LT(photo.chi(), 1.15);
  EXPECT_LT(photo.flow.rms_px(), 0.02);
  EXPECT_GT(seen(as_it_was(*scene)).evaluation.find(1)->photos.at(0).chi(), 5.0);
}

/// The sums hold what the gains' own changes take away: J^T J of residuals' finite differences.
TEST(RestTexture, SumsAreThoseOfTheResiduals) {
  const test::TemporaryFolder folder;
  const auto scene = turned_scene(folder, ", placement: fit");
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  VectorXd p(6);
  p << 0.02, -0.03, 0.01, 0.13, -0.21, 0.4;
  auto look = [&](const VectorXd& at, bool derivatives) {
    EvaluationOptions options;
    options.derivatives = derivatives;
    options.residuals = true;
    auto result = workspace.evaluate(form, at, options);
    return result->examples.at(1).photos.at(0);
  };
  const PhotoEvaluation base = look(p, true);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(base.residual.values.size(), 6);
  const double step[] = {1e-4, 1e-4, 1e-4, 2e-3, 2e-3, 2e-2};
  for (int j = 0; j < 6; ++j) {
    const Image plus = look(p + step[j] * VectorXd::Unit(6, j), false).residual;
    const Image minus = look(p - step[j] * VectorXd::Unit(6, j), false).residual;
    for (size_t i = 0; i < plus.values.size(); ++i)
      if (!std::isnan(plus.values[i]) && !std::isnan(minus.values[i]))
        J(i, j) = (double(plus.values[i]) - minus.values[i]) / (2.0 * step[j]);
  }
  const Eigen::MatrixXd JtJ = J.transpose() * J;
  const VectorXd unit = JtJ.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd off = unit.asDiagonal() * (base.sums.JtJ - JtJ) * unit.asDiagonal();
  for (int i = 0; i < 5; ++i)  // the last, along the view, moves an orthographic picture little
    for (int j = 0; j < 5; ++j) EXPECT_LT(std::abs(off(i, j)), 0.02) << i << " " << j;
}

/// The second example's photo is blurred.
class Blurred final : public Ingredient {
 public:
  std::string name() const override { return "blurred"; }
  std::vector<Parameter> parameters() const override {
    return {{"blur", "px^2", "variance of the blur", 0.0, 0.0, 100.0, 0.1, false}};
  }
  Touches touches() const override { return {.photos = true}; }
  void apply(const VectorXd& values, Model& model) const override {
    model.examples[1].photos[0].blur_variance = values[0];
  }
};

/// A photo some pixels away, through a lens that blurs by the variance `truth`. Between pixels
/// interpolation would blur a little as well.
class BlurOfPhoto {
 public:
  BlurOfPhoto(double px, double truth) {
    const auto moved = [px](double x, double y) { return Eigen::Vector2d(x - px, y - px); };
    write_photo(folder_ / "rest.tif", 1, [](double x, double y) { return Eigen::Vector2d(x, y); });
    write_photo(
        folder_ / "moved.tif", 2, moved, [](double, double) { return 1.0; }, truth);
    write_middle_mask(folder_ / "mask.png");  // what is beyond the rim blurs into the body
    scene_ =
        block_scene(folder_, fmt::format("{{move: [{0}, {1}, 0]}}", px / kScale, -px / kScale));
    form_ = base_form(scene_);
    form_.ingredients.push_back(std::make_shared<Blurred>());
  }
  PhotoEvaluation at(double blur, bool derivatives) const {
    Workspace workspace(scene_);
    EvaluationOptions options;
    options.derivatives = derivatives;
    VectorXd p = form_.initial();
    p.tail<1>()[0] = blur;
    return workspace.evaluate(form_, p, options)->examples.at(1).photos.at(0);
  }
  double step_from(double blur) const {
    const PhotoEvaluation seen = at(blur, true);
    return -seen.sums.Jtr.tail<1>()[0] / seen.sums.JtJ.bottomRightCorner<1, 1>()(0, 0);
  }

 private:
  test::TemporaryFolder folder_;
  std::shared_ptr<const Scene> scene_;
  ModelForm form_;
};

/// Any blur of the model's picture takes noise of the reference photo off. That is no blur of the
/// photo: it would be 7 standard errors of one here.
TEST(RestTexture, NoiseOfTheReferenceIsNoBlur) {
  const BlurOfPhoto sharp(2.0, 0.0);
  const PhotoEvaluation seen = sharp.at(0.0, true);
  const double error = 1.0 / std::sqrt(seen.sums.JtJ.bottomRightCorner<1, 1>()(0, 0));
  EXPECT_LT(sharp.step_from(0.0), 3.0 * error);
  EXPECT_GT(sharp.at(0.001, false).r2, seen.r2 - 2.0);
}

TEST(RestTexture, BlurIsFound) {
  const BlurOfPhoto blurred(2.0, 0.3);
  double found = 0.1;
  for (int i = 0; i < 6; ++i) found += blurred.step_from(found);
  EXPECT_NEAR(found, 0.3, 0.02);
  const PhotoEvaluation seen = blurred.at(0.2, true);
  test::expect_derivative(
      [&](double h) { return VectorXd::Constant(1, blurred.at(0.2 + h, false).r2); },
      VectorXd::Constant(1, 2.0 * seen.sums.Jtr.tail<1>()[0]), 0.01, 0.02, "blur");
}

/// A set-up that stands elsewhere moves the photo that gives the texture as well: the derivative
/// must know of both cameras.
TEST(RestTexture, PlacementMovesTheReferencePhotoToo) {
  const test::TemporaryFolder folder;
  const auto scene = turned_scene(folder, ", placement: fit");
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  ASSERT_EQ(form.size(), 6);
  VectorXd p(6);
  p << 0.02, -0.03, 0.01, 0.13, -0.21, 0.4;
  auto look = [&](const VectorXd& at, bool derivatives) {
    EvaluationOptions options;
    options.derivatives = derivatives;
    auto result = workspace.evaluate(form, at, options);
    if (!result) throw std::runtime_error(result.error().reason);
    return *std::move(result);
  };
  const auto sums = normal_equations(look(p, true));
  for (const VectorXd& direction :
       {VectorXd(Eigen::VectorXd::Unit(6, 2)), VectorXd(Eigen::VectorXd::Unit(6, 3)),
        VectorXd((VectorXd(6) << 1.0, -0.7, 0.2, 3.0, 2.0, -1.0).finished())})
    test::expect_derivative(
        [&](double h) {
          return VectorXd::Constant(1,
                                    look(p + h * direction, false).examples.at(1).photos.at(0).r2);
        },
        VectorXd::Constant(1, 2.0 * sums.Jtr.dot(direction)), 2e-4, 0.01);
}

/// The misfit's slope by every candidate of an effect, a little off its nulls. Returns how many of
/// its parameters have one.
int check_slopes(const std::string& name, double step, bool follows = true) {
  const test::TemporaryFolder folder;
  auto scene = std::make_shared<Scene>(*turned_scene(folder));
  if (!follows) scene = as_it_was(*scene);
  Workspace workspace(scene);
  const ModelForm base = base_form(scene);
  int tried = 0;
  for (const auto& candidate :
       find_effect(name)->candidates(base.realise(base.initial()), nullptr)) {
    ModelForm form = base;
    form.ingredients.push_back(candidate);
    const auto parameters = form.parameters();
    VectorXd p = form.initial();
    for (Eigen::Index i = base.size(); i < p.size(); ++i) p[i] += 0.3 * parameters[i].typical;
    auto look = [&](const VectorXd& at, bool derivatives) {
      EvaluationOptions options;
      options.derivatives = derivatives;
      return workspace.evaluate(form, at, options).value();
    };
    const auto misfit = [&](Eigen::Index i, double h) {
      return look(p + h * VectorXd::Unit(p.size(), i), false).examples.at(1).photos.at(0).r2;
    };
    const auto sums = normal_equations(look(p, true));
    for (Eigen::Index i = base.size(); i < p.size(); ++i) {
      const std::string label = name + " [" + candidate->variant() + "] " + parameters[i].name;
      const double h = step * parameters[i].typical;
      if (sums.JtJ(i, i) * std::pow(parameters[i].typical, 2) < 1.0) {
        // The distance of an orthographic camera; a gain, which the picture follows.
        EXPECT_NEAR(misfit(i, h), misfit(i, -h), 1e-6 * misfit(i, 0.0)) << label;
        continue;
      }
      test::expect_derivative([&](double t) { return VectorXd::Constant(1, misfit(i, t)); },
                              VectorXd::Constant(1, 2.0 * sums.Jtr[i]), h, 0.01, label);
      ++tried;
    }
  }
  return tried;
}

/// The photo that gives the texture was taken by a camera and with an exposure of its own: what
/// changes these changes every picture, and derivatives know it.
TEST(RestTexture, WhatTheReferencePhotoWasTakenWithCounts) {
  // both photos zoom: what is left is small beside the rounding of pictures kept as floats
  EXPECT_GT(check_slopes("focal_length", 8e-3), 0);
  EXPECT_GT(check_slopes("camera_pose", 2e-3), 0);
  // A gain of the photo at rest alone is no number of the photo that is compared.
  EXPECT_GT(check_slopes("exposure", 2e-3, false), 0);
  EXPECT_EQ(check_slopes("exposure", 2e-3), 0) << "the picture follows the photo's brightness";
}

/// What bends the body in every example bends it in the photo that gives the texture as well.
TEST(RestTexture, WhatMovesTheBodyAtRestCounts) { EXPECT_GT(check_slopes("gravity", 0.05), 0); }

/// A body that hangs in one jaw is at rest wherever the jaw went: such photos tell the floor.
TEST(RestTexture, BodyHeldByOneJawIsAtRest) {
  const test::TemporaryFolder folder;
  write_photo(folder / "rest.tif", 1, [](double x, double y) { return Eigen::Vector2d(x, y); });
  write_photo(folder / "moved.tif", 2, [](double x, double y) { return Eigen::Vector2d(x, y); });
  const auto scene = block_scene(folder, "fit");
  EXPECT_TRUE(is_rest(scene->capture.examples.at(1)));
  ExampleSpec pulled = scene->capture.examples.at(1);
  pulled.supports.push_back(pulled.supports.front());
  EXPECT_FALSE(is_rest(pulled));
}

}  // namespace
}  // namespace hookeye
