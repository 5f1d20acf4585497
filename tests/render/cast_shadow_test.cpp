// The sun's shadow of one ball on another: where it falls, and the derivatives on both of its sides
// and at its edge.
#include <algorithm>

#include "render/renderer.h"
#include "scene.h"
#include "support/derivative.h"

namespace hookeye {
namespace {

struct CastShadow : testing::Test {
  const Vector3d small_centre{3, 2, -12}, large_centre{-1, 0, 4};
  const double small_radius = 3, large_radius = 9;

  CastShadow()
      : surface(test::both(test::sphere(small_centre, small_radius, 4),
                           test::sphere(large_centre, large_radius, 5))),
        renderer(surface) {
    texture.source = Texture::Source::uniform;
    texture.albedo = 0.8;
    state = test::state(test::camera("perspective", false));
    // From the side, so that the shadow falls beside the ball that casts it.
    state.sun = Vector3d(0.45, 0.25, -0.5);
    options.visibility_rays = 0;
  }

  Image picture(const Matrix3Xd& x, const PhotoState& photo) {
    RenderOptions o = options;
    o.derivatives = false;
    return renderer.render(x, nullptr, texture, photo, o, false).I;
  }

  /// Of what a pixel's centre sees of the large ball: how far [length] the small ball's axis to the
  /// sun passes, less its radius; negative: in its shadow. NaN: it sees none of it.
  double beside_shadow(int u, int v) const {
    const auto ray = state.camera.ray({u, v});
    const Vector3d direction = ray.direction.normalized();
    const auto hit = [&](const Vector3d& centre, double radius) {
      const Vector3d to = ray.origin - centre;
      const double b = to.dot(direction), root = b * b - to.squaredNorm() + radius * radius;
      return root < 0.0 ? std::nan("") : -b - std::sqrt(root);
    };
    const double t = hit(large_centre, large_radius);
    if (!std::isfinite(t) || std::isfinite(hit(small_centre, 1.2 * small_radius)))
      return std::nan("");
    const Vector3d X = ray.origin + t * direction, to_sun = state.sun.normalized();
    if ((X - large_centre).normalized().dot(to_sun) < 0.2) return std::nan("");
    const Vector3d away = small_centre - X;
    return (away - away.dot(to_sun) * to_sun).norm() - small_radius;
  }

  SurfaceMesh surface;
  Renderer renderer;
  Texture texture;
  PhotoState state;
  RenderOptions options;
};

TEST_F(CastShadow, falls_where_the_ball_stands_before_the_sun) {
  state.specular = 0.0;
  const Image I = picture(surface.X, state);
  options.cast_shadows = false;
  const Image without = picture(surface.X, state);
  const float sky_alone = static_cast<float>(state.gain * texture.albedo * state.ambient);
  int dark = 0, lit = 0;
  for (int v = 0; v < I.height; ++v)
    for (int u = 0; u < I.width; ++u) {
      const double beside = beside_shadow(u, v);
      if (beside < -0.7) {  // a pixel is 0.4 wide there, its filter three
        ++dark;
        EXPECT_NEAR(I.at(u, v), sky_alone, 1e-4 * sky_alone) << u << ", " << v;
        EXPECT_GT(without.at(u, v), 1.2f * sky_alone) << u << ", " << v;
      } else if (beside > 0.7) {
        ++lit;
        EXPECT_NEAR(I.at(u, v), without.at(u, v), 1e-6) << u << ", " << v;
      }
    }
  EXPECT_GT(dark, 50);
  EXPECT_GT(lit, 300);
}

TEST_F(CastShadow, derivatives_on_both_sides) {
  texture.source = Texture::Source::image;
  texture.image = test::waves(1024, 1024, 4);
  const Rendering r = renderer.render(surface.X, nullptr, texture, state, options, false);
  std::vector<int> pixels;
  int dark = 0;
  const test::Joined dI = test::joined(r.dI);
  for (const int px : dI.pixel) {
    const double beside = beside_shadow(px % r.I.width, px / r.I.width);
    if (std::isfinite(beside) && std::abs(beside) > 0.9 && r.coverage.values[px] == 1.0f) {
      pixels.push_back(px);
      dark += beside < 0.0;
    }
  }
  ASSERT_GT(dark, 30);
  ASSERT_GT(pixels.size(), 300u);
  const auto pick = [&](const auto& values) {
    VectorXd out(Eigen::Index(pixels.size()));
    for (size_t i = 0; i < pixels.size(); ++i) out[i] = values[pixels[i]];
    return out;
  };
  // As in Interior.positions_where_facets_matter: nine pixels in ten have no jump within the step.
  const Matrix3Xd u = test::field(surface.X, 0.3);
  const VectorXd analytic =
      pick(test::directional(renderer, r, surface.X, &u, nullptr, VectorXd::Zero(kPhotoColumns)));
  const auto f = [&](double h) { return pick(picture(surface.X + h * u, state).values); };
  const VectorXd numeric = (f(3e-4) - f(-3e-4)) / 6e-4;
  for (const bool in_shadow : {true, false}) {
    std::vector<double> error;
    double size = 0.0;
    for (size_t i = 0; i < pixels.size(); ++i) {
      if ((beside_shadow(pixels[i] % r.I.width, pixels[i] / r.I.width) < 0.0) != in_shadow)
        continue;
      error.push_back(std::abs(numeric[i] - analytic[i]));
      size += std::abs(numeric[i]);
    }
    const auto tenth = error.begin() + static_cast<std::ptrdiff_t>(error.size() * 9 / 10);
    std::nth_element(error.begin(), tenth, error.end());
    ASSERT_GT(size, 0.0);
    EXPECT_LT(*tenth, 1e-2 * size / static_cast<double>(error.size()))
        << (in_shadow ? "in the shadow" : "beside it");
  }
  for (int axis = 0; axis < 3; ++axis)
    test::expect_derivative(
        [&](double h) {
          PhotoState s = state;
          s.sun[axis] += h;
          return pick(picture(surface.X, s).values);
        },
        pick(test::directional(renderer, r, surface.X, nullptr, nullptr,
                               VectorXd::Unit(kPhotoColumns, kSun + axis))),
        0.004, 1e-3, "sun " + std::to_string(axis));
}

/// A plate with a wall along one side of it, whose shadow falls on the plate: an L drawn out along
/// y. The wall's free end, towards the camera, has the first four vertices.
SurfaceMesh plate_with_wall() {
  const std::vector<std::array<double, 2>> outline = {{-9, -4}, {-5, -4}, {-5, 4},
                                                      {9, 4},   {9, 8},   {-9, 8}};
  const int n = static_cast<int>(outline.size());
  SurfaceMesh out;
  out.X.resize(3, 2 * n);
  for (int k = 0; k < n; ++k)
    for (int end : {0, 1})
      out.X.col(2 * k + end) = Vector3d(outline[k][0], end ? 8 : -8, outline[k][1]);
  // Oblique to the rows and columns of pixels.
  const Eigen::AngleAxisd turn(0.4, Vector3d(0.1, 0.2, 1).normalized());
  out.X = (turn.toRotationMatrix() * out.X).eval();
  const auto add = [&](int a, int b, int c) { out.triangles.push_back({a, b, c}); };
  for (int k = 0; k < n; ++k) {
    const int a = 2 * k, b = 2 * ((k + 1) % n);
    add(a, a + 1, b), add(b, a + 1, b + 1);
  }
  const int corner = 2 * (n - 1);  // sees all others of its end
  for (int k = 0; k + 2 < n; ++k) {
    const int a = 2 * k, b = 2 * (k + 1);
    add(corner, a, b), add(corner + 1, b + 1, a + 1);
  }
  return out;
}

/// Derivatives at the shadow's edge, by sums over blocks of pixels (block_sums): 16 x 16 rays a
/// pixel and steps of up to a pixel leave 0.2 to 2.2 %. Without the edge's motion 75 % and more are
/// missing at the ball's shadow, and of a derivative by the sun 41 to 100 % at the wall's.
struct ShadowEdge : CastShadow {
  ShadowEdge() {
    state.specular = 0.0;
    options.rays_per_axis = 16;
  }

  VectorXd blocks(const VectorXd& all) const {
    const int width = state.camera.width;
    VectorXd out = VectorXd::Zero(all.size());
    for (int i = 0; i < all.size(); ++i)
      if (everywhere || std::abs(beside_shadow(i % width, i / width)) < 2.0)  // false for NaN
        out[i] = all[i];
    return test::block_sums(out, width, state.camera.height);
  }
  void compare(const Matrix3Xd* u, const VectorXd& columns, double h,
               const std::function<PhotoState(double)>& photo, const std::string& what) {
    const auto f = [&](double step) {
      const Matrix3Xd x = u ? Matrix3Xd(surface.X + step * *u) : surface.X;
      const Image I = picture(x, photo(step));
      return blocks(
          VectorXd(Eigen::Map<const Eigen::VectorXf>(I.values.data(), Eigen::Index(I.pixels()))
                       .cast<double>()));
    };
    const VectorXd numeric = (f(h) - f(-h)) / (2 * h);
    const Rendering r = renderer.render(surface.X, nullptr, texture, state, options, true);
    const VectorXd ours = blocks(test::directional(renderer, r, surface.X, u, nullptr, columns));
    ASSERT_GT(numeric.norm(), 0.0) << what;
    EXPECT_LT((numeric - ours).norm(), 0.03 * numeric.norm())
        << what << ": analytic " << ours.norm() << ", difference " << numeric.norm();
  }
  /// `casting`: the first vertices, which cast the shadow.
  void compare_positions(Eigen::Index casting, const std::string& what) {
    for (const bool receiving : {false, true}) {
      Matrix3Xd u = test::field(surface.X, 0.3);
      (receiving ? u.leftCols(casting) : u.rightCols(u.cols() - casting)).setZero();
      compare(
          &u, VectorXd::Zero(kPhotoColumns), 0.1, [&](double) { return state; },
          what + (receiving ? ", receiving" : ", casting"));
    }
  }
  void compare_sun_and_camera(const std::string& what) {
    const bool parallel = !state.camera.model->central();
    for (int column = 0; column < kSpecular; ++column) {
      if (column == kLogGain || column == kAmbient) continue;  // move no edge
      if (parallel && column == kMove + 2) continue;  // along the line of sight: nothing moves
      const double h = column < 2    ? test::turning_step(state.camera)
                       : column == 2 ? 0.03
                       : column < 5  ? 0.1
                       : column == 5 ? 0.02 * state.camera.t.z()
                                     : 0.02;
      compare(
          nullptr, VectorXd::Unit(kPhotoColumns, column), h,
          [&](double step) {
            PhotoState s = state;
            if (column < kLogGain) return test::with_camera(s, column, step);
            s.sun[column - kSun] += step;
            return s;
          },
          what + ", column " + std::to_string(column));
    }
  }

  bool everywhere = false;  ///< false: pixels about the shadow's edge that see no rim
};

TEST_F(ShadowEdge, of_a_ball_on_another) {
  compare_positions(test::sphere(small_centre, small_radius, 4).X.cols(), "balls");
  compare_sun_and_camera("balls");
}

TEST_F(ShadowEdge, before_other_cameras) {
  state.camera = test::camera("perspective", true);
  compare_sun_and_camera("distorted");
  state.camera = test::camera("fisheye", true);
  compare_sun_and_camera("fisheye");
  state.camera = test::camera("orthographic", false);
  compare_sun_and_camera("orthographic");
}

TEST_F(ShadowEdge, of_a_wall_on_its_plate) {
  surface = plate_with_wall();
  renderer = Renderer(surface);
  options.smooth_normals = false;
  state.sun = Vector3d(-0.5, 0.3, -0.6);
  everywhere = true;
  compare_positions(4, "wall");
  compare_sun_and_camera("wall");
}

}  // namespace
}  // namespace hookeye
