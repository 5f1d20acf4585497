// The contour term: sums over blocks of pixels along the edges (block_sums), 16 x 16 rays a pixel
// and steps of a good part of a pixel.
#include "render/renderer.h"
#include "scene.h"
#include "support/derivative.h"

namespace hookeye {
namespace {

struct Contours : testing::Test {
  // A small bright ball before a large dark one: outer contours and one within the body.
  Contours() {
    front = test::sphere({0, 0, -9}, 4, 3, 0.0, {0.25, 0});
    surface = test::both(front, test::sphere({2, 1, 4}, 8, 3, 0.03, {-0.25, 0}));
    texture.source = Texture::Source::image;
    auto image = std::make_shared<Image>(Image{64, 64, 1, std::vector<float>(64 * 64, 0.2f)});
    for (int y = 0; y < 64; ++y)
      for (int x = 32; x < 64; ++x) image->at(x, y) = 0.9f;
    texture.image = image;
    state = test::state(test::camera("perspective", false));
    state.shaded = false;
    options.rays_per_axis = 16;
    options.visibility_rays = 0;
  }
  VectorXd picture(Renderer& renderer, const Matrix3Xd& x, const PhotoState& s) {
    RenderOptions o = options;
    o.derivatives = false;
    return Eigen::Map<Eigen::VectorXf>(
               renderer.render(x, &surface.X, texture, s, o, true).I.values.data(),
               state.camera.width * state.camera.height)
        .cast<double>();
  }
  void compare(const VectorXd& analytic, const std::function<VectorXd(double)>& f, double h,
               const std::string& what) {
    const int w = state.camera.width, height = state.camera.height;
    const VectorXd numeric = test::block_sums((f(h) - f(-h)) / (2 * h), w, height);
    const VectorXd ours = test::block_sums(analytic, w, height);
    ASSERT_GT(numeric.norm(), 0) << what;
    EXPECT_LT((numeric - ours).norm(), 0.02 * numeric.norm())
        << what << ": analytic " << ours.norm() << ", difference " << numeric.norm();
  }

  /// By a smooth motion of all vertices.
  void compare_positions(const std::string& what, double h = 0.1) {
    compare_motion(test::field(surface.X, 0.3), what, h);
  }
  void compare_motion(const Matrix3Xd& u, const std::string& what, double step = 0.1) {
    Renderer renderer(surface);
    const Rendering r = renderer.render(surface.X, nullptr, texture, state, options, true);
    compare(
        test::directional(renderer, r, surface.X, &u, nullptr, VectorXd::Zero(kPhotoColumns)),
        [&](double h) { return picture(renderer, surface.X + h * u, state); }, step,
        what + ", positions");
  }

  /// The columns from the exposure to the light.
  void compare_light(const std::string& what) {
    Renderer renderer(surface);
    const Rendering r = renderer.render(surface.X, nullptr, texture, state, options, true);
    for (int column = kLogGain; column < kSpecular; ++column)
      compare(
          test::directional(renderer, r, surface.X, nullptr, nullptr,
                            VectorXd::Unit(kPhotoColumns, column)),
          [&](double h) {
            PhotoState s = state;
            if (column == kLogGain)
              s.gain *= std::exp(h);
            else if (column == kAmbient)
              s.ambient += h;
            else
              s.sun[column - kSun] += h;
            return picture(renderer, surface.X, s);
          },
          0.01, what + ", column " + std::to_string(column));
  }

  /// All columns of the camera.
  void compare_camera(const std::string& what) {
    Renderer renderer(surface);
    const Rendering r = renderer.render(surface.X, &surface.X, texture, state, options, true);
    const bool parallel = !state.camera.model->central();
    for (int column = 0; column < kLogGain; ++column) {
      if (parallel && column == kMove + 2) continue;  // along the line of sight: nothing moves
      const auto f = [&](double h) {
        return picture(renderer, surface.X, test::with_camera(state, column, h));
      };
      const double h = column < 2    ? test::turning_step(state.camera)
                       : column == 2 ? 0.03
                       : column < 5  ? 0.1
                       : column == 5 ? 0.01 * state.camera.t.z()
                                     : 0.01;
      compare(test::directional(renderer, r, surface.X, nullptr, nullptr,
                                VectorXd::Unit(kPhotoColumns, column)),
              f, h, what + ", column " + std::to_string(column));
    }
  }

  SurfaceMesh front, surface;
  Texture texture;
  PhotoState state;
  RenderOptions options;
};

TEST_F(Contours, positions) {
  for (bool distorted : {false, true})
    for (const CameraModel* model : camera_models()) {
      state.camera = test::camera(model->name(), distorted);
      // Twice the step, half the noise of rays that come to lie beyond an edge.
      const double step = state.camera.straight() ? 0.1 : 0.2;
      compare_positions(model->name() + (distorted ? ", distorted" : ""), step);
    }
}

// Each end of an edge moves it by its own share, which motions that are smooth over the mesh hide:
// here neighbours move otherwise. The plate ends at its rim.
TEST_F(Contours, ends_of_edges) {
  texture.source = Texture::Source::uniform;
  texture.albedo = 0.8;
  surface = {};
  surface.X.resize(3, 4);
  surface.X << -7, 6, 8, -5, -5, -6, 5, 6, 1, 0, 2, -1;
  surface.triangles = {{0, 2, 1}, {0, 3, 2}};
  compare_motion(test::field(20 * surface.X, 0.3), "plate");
}

// However few the rays, contours have the same share in the whole picture: so have pixels that they
// cross although no ray of the pattern meets the body there.
TEST_F(Contours, few_rays) {
  texture.source = Texture::Source::uniform;
  texture.albedo = 0.8;
  Renderer renderer(surface);
  const Matrix3Xd u = test::field(surface.X, 0.3);
  const double h = 0.1;
  const double numeric = (picture(renderer, surface.X + h * u, state).sum() -
                          picture(renderer, surface.X - h * u, state).sum()) /
                         (2 * h);
  for (int rays : {1, 2, 3}) {
    options.rays_per_axis = rays;
    options.filter_width_px = rays == 1 ? 1.0 : RenderOptions().filter_width_px;
    const Rendering r = renderer.render(surface.X, nullptr, texture, state, options, true);
    const VectorXd d =
        test::directional(renderer, r, surface.X, &u, nullptr, VectorXd::Zero(kPhotoColumns));
    double sum = 0;
    for (const double one : d)
      if (std::isfinite(one)) sum += one;
    EXPECT_NEAR(sum, numeric, 0.02 * std::abs(numeric)) << rays << " rays";
  }
}

TEST_F(Contours, inner_edge_alone) {
  Renderer renderer(surface);
  const Rendering r = renderer.render(surface.X, nullptr, texture, state, options, false);
  Matrix3Xd u = Matrix3Xd::Zero(3, surface.X.cols());
  u.leftCols(front.X.cols()) = test::field(front.X, 1.0);
  // Pixels that body covers wholly; nothing but the front ball moves.
  VectorXd analytic =
      test::directional(renderer, r, surface.X, &u, nullptr, VectorXd::Zero(kPhotoColumns));
  ASSERT_GT(r.dI.pixels(), 500u);
  compare(
      analytic,
      [&](double h) {
        VectorXd I = picture(renderer, surface.X + h * u, state);
        for (int i = 0; i < I.size(); ++i)
          if (!std::isfinite(analytic[i])) I[i] = 0;
        return I;
      },
      0.1, "inner edge");
}

TEST_F(Contours, camera) { compare_camera("image"); }

TEST_F(Contours, orthographic_camera) {
  state.camera = test::camera("orthographic", false);
  compare_camera("orthographic");
}

TEST_F(Contours, fisheye_camera) {
  state.camera = test::camera("fisheye", true);
  compare_camera("fisheye");
}

TEST_F(Contours, camera_before_uniform_bodies) {
  texture.source = Texture::Source::uniform;
  texture.albedo = 0.8;
  // Lit, so that the balls differ where one is before the other.
  state.shaded = true;
  state.ambient = state.specular = 0.0;
  options.cast_shadows = false;
  compare_camera("uniform");
}

TEST_F(Contours, camera_of_photographed_bodies) {
  // The reference stands still while the camera moves; what it does not see stays uncovered.
  surface = front;
  texture.source = Texture::Source::photo;
  texture.photo = test::waves(state.camera.width, state.camera.height, 3);
  texture.reference_camera = state.camera;
  compare_camera("photo");
}

TEST_F(Contours, before_a_picture) {
  // Bright here and dark there: the ball's contrast changes its sign along the contour.
  state.backdrop = test::waves(state.camera.width, state.camera.height, 2);
  Renderer renderer(surface);
  const Rendering r = renderer.render(surface.X, nullptr, texture, state, options, true);
  EXPECT_EQ(r.I.at(0, 0), state.backdrop->at(0, 0));
  const Matrix3Xd u = test::field(surface.X, 0.3);
  compare(
      test::directional(renderer, r, surface.X, &u, nullptr, VectorXd::Zero(kPhotoColumns)),
      [&](double h) { return picture(renderer, surface.X + h * u, state); }, 0.1, "positions");
  // Every pixel is its share of the body and its share of the picture behind.
  PhotoState dark = state;
  dark.backdrop = nullptr, dark.background = 0.0;
  const Rendering body = renderer.render(surface.X, nullptr, texture, dark, options, true);
  for (size_t i = 0; i < r.I.pixels(); ++i)
    ASSERT_NEAR(r.I.values[i],
                body.I.values[i] + (1.0f - body.coverage.values[i]) * state.backdrop->values[i],
                1e-5);
  state.backdrop = test::waves(state.camera.width, state.camera.height + 1, 2);
  EXPECT_THROW(renderer.render(surface.X, nullptr, texture, state, options, true),
               std::invalid_argument);
}

TEST_F(Contours, lit) {
  state.shaded = true;
  state.specular = 0.0;
  // Held constant (render/README.md): the jump of the sky's share at facets.
  const double ambient = std::exchange(state.ambient, 0.0);
  compare_positions("lit");
  // Light and exposure, at the rim too.
  state.ambient = ambient;
  compare_light("lit");
}

// Every edge between two facets that are seen moves a jump of the intensity. Without it 40 % of a
// derivative by positions are missing and 50 to 85 % of those by the camera.
TEST_F(Contours, flat_facets) {
  // One of the front ball's facets at its rim is seen 0.004 px wide.
  surface = test::both(test::sphere({0, 0, -9}, 4, 2), test::sphere({2, 1, 4}, 8, 2, 0.03));
  texture.source = Texture::Source::uniform;
  texture.albedo = 0.8;
  state.shaded = true;
  options.smooth_normals = options.cast_shadows = false;
  compare_positions("flat");
  compare_camera("flat");
  compare_light("flat");
  state.camera = test::camera("orthographic", false);
  compare_camera("flat, orthographic");
}

// Across a seam the colour jumps although the surface is smooth.
TEST_F(Contours, seam_of_the_texture) {
  surface = test::sphere({2, 1, 4}, 8, 3);
  // The background is as bright as the side beyond the seam: half of the contour does not count.
  state.background = 0.9 * state.gain;
  for (size_t f = 0; f < surface.triangles.size(); ++f) {
    const auto& t = surface.triangles[f];
    const Vector3d middle = (surface.X.col(t[0]) + surface.X.col(t[1]) + surface.X.col(t[2])) / 3;
    for (Vector2d& uv : surface.uv[f])
      uv = middle.x() + middle.y() > 2 ? Vector2d(0.2, 0.5) : Vector2d(0.8, 0.5);
  }
  compare_positions("seam");
  compare_camera("seam");
}

TEST_F(Contours, background_and_blur) {
  state.blur_variance = 0.4;
  options.rays_per_axis = 3;
  Renderer renderer(surface);
  const Rendering r = renderer.render(surface.X, nullptr, texture, state, options, true);
  const auto at = [&](const VectorXd& all) {
    VectorXd out(Eigen::Index(r.dI.pixels()));
    r.dI.for_each_pixel([&](size_t i, int pixel) { out[i] = all[pixel]; });
    return out;
  };
  test::expect_derivative(
      [&](double h) {
        PhotoState s = state;
        s.blur_variance += h;
        return at(picture(renderer, surface.X, s));
      },
      test::joined(r.dI).d_photo.row(kBlur).transpose().cast<double>(), 0.02, 1e-3, "blur");
  state.blur_variance = 0;
  const Rendering sharp = renderer.render(surface.X, nullptr, texture, state, options, true);
  test::expect_derivative(
      [&](double h) {
        PhotoState s = state;
        s.background += h;
        return at(picture(renderer, surface.X, s));
      },
      test::joined(sharp.dI).d_photo.row(kBackground).transpose().cast<double>(), 0.02, 1e-4,
      "background");
}

TEST(blur, is_a_semigroup_that_keeps_the_mean) {
  const auto image = test::waves(40, 30, 3);
  const Image once = blur(*image, 0.8), twice = blur(blur(*image, 0.3), 0.5);
  double sum = 0, before = 0, worst = 0;
  for (int y = 8; y < 22; ++y)  // away from the border, which is repeated
    for (int x = 8; x < 32; ++x)
      worst = std::max(worst, double(std::abs(once.at(x, y) - twice.at(x, y))));
  Image spot{41, 41, 1, std::vector<float>(41 * 41, 0.0f)};
  spot.at(20, 20) = 1;
  const Image spread = blur(spot, 1.7);
  double variance = 0;
  for (int y = 0; y < 41; ++y)
    for (int x = 0; x < 41; ++x) {
      sum += spread.at(x, y), before += spot.at(x, y);
      variance += (x - 20) * (x - 20) * spread.at(x, y);
    }
  EXPECT_LT(worst, 1e-6);
  EXPECT_NEAR(sum, before, 1e-5);
  EXPECT_NEAR(variance, 1.7, 1e-4);
}

}  // namespace
}  // namespace hookeye
