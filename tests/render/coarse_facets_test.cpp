// Derivatives on facets of many pixels, where the normals of the corners are far from the facet's
// own and the sky is seen differently from corner to corner: terms that a fine mesh hides.
#include "meshing/subdivide.h"
#include "render/renderer.h"
#include "scene.h"
#include "support/derivative.h"

namespace hookeye {
namespace {

using test::expect_derivative;
using Source = Texture::Source;

enum class Look { textured, gloss_alone, sky_alone };

struct Setting {
  Look look;
  bool distorted;
};

std::string name_of(const testing::TestParamInfo<Setting>& info) {
  const char* names[] = {"textured", "gloss_alone", "sky_alone"};
  return std::string(names[static_cast<int>(info.param.look)]) +
         (info.param.distorted ? "_distorted" : "");
}

/// The camera of the other tests with three times as many pixels along the same picture.
Camera close_up(bool distorted) {
  Camera c = test::camera("perspective", distorted);
  c.width *= 3, c.height *= 3;
  c.fx *= 3, c.fy *= 3, c.cx *= 3, c.cy *= 3;
  return c;
}

/// Two balls of 80 facets each, side by side: each hides a part of the other's sky.
class CoarseFacets : public testing::TestWithParam<Setting> {
 protected:
  CoarseFacets()
      : surface(test::both(test::sphere(Vector3d(-5, 0, 0), 6, 1, 0.05),
                           test::sphere(Vector3d(7, 1, 1), 5, 1, 0.05))),
        renderer(surface),
        state(test::state(close_up(GetParam().distorted))) {
    texture.source = GetParam().look == Look::textured ? Source::image : Source::uniform;
    texture.albedo = GetParam().look == Look::sky_alone ? 0.8 : 0.0;
    if (GetParam().look == Look::sky_alone) state.sun.setZero();
    texture.image = test::waves(1024, 1024, 4);
  }

  Rendering render(const Matrix3Xd& x, const PhotoState& photo, bool derivatives) {
    RenderOptions o = options;
    o.derivatives = derivatives;
    return renderer.render(x, nullptr, texture, photo, o, false);
  }
  /// Pixels whose rays stay on one facet.
  void choose_pixels(const Rendering& r) {
    const Image& I = r.I;
    const test::Joined dI = test::joined(r.dI);
    for (const int px : dI.pixel) {
      const int u = px % I.width, v = px / I.width;
      bool inside = u > 1 && v > 1 && u < I.width - 2 && v < I.height - 2;
      for (int dv = -2; inside && dv <= 2; ++dv)
        for (int du = -2; du <= 2; ++du)
          inside = inside && r.triangle[px + dv * I.width + du] == r.triangle[px] &&
                   r.coverage.at(u + du, v + dv) == 1.0f;
      if (inside) pixels.push_back(px);
    }
    ASSERT_GT(pixels.size(), 100u);
  }
  VectorXd pick(const auto& all) const {
    VectorXd out(Eigen::Index(pixels.size()));
    for (size_t i = 0; i < pixels.size(); ++i) out[Eigen::Index(i)] = all[pixels[i]];
    return out;
  }

  SurfaceMesh surface;
  Renderer renderer;
  PhotoState state;
  Texture texture;
  RenderOptions options;
  std::vector<int> pixels;
};

TEST_P(CoarseFacets, positions) {
  options.visibility_rays = 0;  // derivatives take the sky seen by a corner as given
  const Rendering r = render(surface.X, state, true);
  choose_pixels(r);
  for (double phase : {0.2, 1.5}) {
    const Matrix3Xd u = test::field(surface.X, phase);
    const VectorXd analytic =
        pick(test::directional(renderer, r, surface.X, &u, nullptr, VectorXd::Zero(kPhotoColumns)));
    expect_derivative(
        [&](double h) { return pick(render(surface.X + h * u, state, false).I.values); }, analytic,
        GetParam().look == Look::sky_alone ? 0.01 : 0.002, 1e-3, "positions");
  }
}

TEST_P(CoarseFacets, camera_and_light) {
  const Rendering r = render(surface.X, state, true);
  choose_pixels(r);
  // the sky's light changes so little that the rounding of pixels shows at small steps
  const double larger = GetParam().look == Look::sky_alone ? 5.0 : 1.0;
  const auto check = [&](int column, double h, const auto& change) {
    const VectorXd unit = VectorXd::Unit(kPhotoColumns, column);
    expect_derivative(
        [&](double t) {
          PhotoState s = state;
          change(s, t);
          return pick(render(surface.X, s, false).I.values);
        },
        pick(test::directional(renderer, r, surface.X, nullptr, nullptr, unit)), larger * h, 1e-3,
        "column " + std::to_string(column));
  };
  for (int k = 0; k < 3; ++k) {
    check(kRotate + k, 1e-4, [k](PhotoState& s, double t) {
      s.camera = s.camera.moved(t * Vector3d::Unit(k), Vector3d::Zero());
    });
    check(kMove + k, 0.004, [k](PhotoState& s, double t) {
      s.camera = s.camera.moved(Vector3d::Zero(), t * Vector3d::Unit(k));
    });
    if (GetParam().look == Look::sky_alone) continue;  // a sun of no strength has no direction
    check(kSun + k, 0.002, [k](PhotoState& s, double t) { s.sun[k] += t; });
  }
  check(kZoom, 1e-4, [](PhotoState& s, double t) { s.camera = s.camera.zoomed(t); });
  if (GetParam().look != Look::gloss_alone)  // without albedo no sky is seen
    check(kAmbient, 0.01, [](PhotoState& s, double t) { s.ambient += t; });
  if (GetParam().look != Look::sky_alone)
    check(kSpecular, 0.01, [](PhotoState& s, double t) { s.specular += t; });
}

/// Facets that the sun does not reach know nothing of it.
TEST(NightSide, sun) {
  const SurfaceMesh surface = test::sphere(Vector3d::Zero(), 8, 1, 0.05);
  Renderer renderer(surface);
  PhotoState state = test::state(close_up(false));
  state.sun = 0.7 * (state.camera.R.transpose() * Vector3d(1, -0.2, 0.1)).normalized();
  Texture texture;
  texture.albedo = 0.8;
  const Rendering r = renderer.render(surface.X, nullptr, texture, state, {}, true);
  const Matrix3Xd normals = renderer.normals(surface.X);
  for (int k = 0; k < 3; ++k) {
    const VectorXd d = test::directional(renderer, r, surface.X, nullptr, nullptr,
                                         VectorXd::Unit(kPhotoColumns, kSun + k));
    int night = 0;
    const test::Joined dI = test::joined(r.dI);
    for (const int px : dI.pixel) {
      bool dark = true, alone = true;
      for (int by : {-2, 0, 2})
        for (int by_row : {-2, 0, 2}) {
          const int other = px + by + by_row * r.I.width;
          alone = alone && r.triangle[other] == r.triangle[px];
        }
      if (!alone || r.triangle[px] < 0) continue;
      for (const int v : surface.triangles[r.triangle[px]])
        dark = dark && normals.col(v).dot(state.sun) < -0.05;
      if (!dark) continue;
      ++night;
      EXPECT_EQ(d[px], 0.0) << px;
    }
    EXPECT_GT(night, 50);
  }
}

INSTANTIATE_TEST_SUITE_P(all, CoarseFacets,
                         testing::Values(Setting{Look::textured, false},
                                         Setting{Look::textured, true},
                                         Setting{Look::gloss_alone, false},
                                         Setting{Look::gloss_alone, true},
                                         Setting{Look::sky_alone, false}),
                         name_of);

/// A facet that is cut for the body to bend has the light of the whole one: smooth normals are
/// interpolated from its corners, and what they lean towards hides no sky.
TEST(CutFacets, AreLitAsTheWholeOnes) {
  const SurfaceMesh whole = test::sphere(Vector3d::Zero(), 8, 1, 0.05);
  const SurfaceMesh cut = detail::subdivide(whole, 1.5).mesh;
  ASSERT_GT(cut.triangles.size(), 10 * whole.triangles.size());
  PhotoState state = test::state(close_up(false));
  ASSERT_GT(state.ambient, 0.1);
  ASSERT_GT(state.sun.norm(), 0.1);
  Texture texture;
  texture.albedo = 0.8;
  RenderOptions options;
  options.cast_shadows = false;
  Renderer of_whole(whole), of_cut(cut);
  SurfaceMesh forgotten = cut;  // that it was cut
  forgotten.cut_from.clear(), forgotten.cut_weights.resize(0, 0);
  Renderer of_forgotten(forgotten);
  const Rendering a = of_whole.render(whole.X, nullptr, texture, state, options, false);
  const Rendering b = of_cut.render(cut.X, nullptr, texture, state, options, false);
  const Rendering c = of_forgotten.render(cut.X, nullptr, texture, state, options, false);
  int seen = 0;
  double most = 0.0, most_forgotten = 0.0;
  for (int px = 0; px < a.I.width * a.I.height; ++px) {
    if (a.triangle[px] < 0 || b.triangle[px] < 0) continue;
    ++seen;
    most = std::max<double>(most, std::abs(a.I.values[px] - b.I.values[px]));
    most_forgotten = std::max<double>(most_forgotten, std::abs(a.I.values[px] - c.I.values[px]));
  }
  EXPECT_LT(most, 1e-3);  // between cut corners the normals turn as chords of the whole one's arcs
  EXPECT_GT(most_forgotten, 0.03);
  EXPECT_GT(seen, 2000);
}

TEST(CutFacets, NormalsHaveTheirDerivative) {
  const SurfaceMesh cut = detail::subdivide(test::sphere(Vector3d::Zero(), 8, 1, 0.2), 2.0).mesh;
  const Renderer renderer(cut);
  const Matrix3Xd u = test::field(cut.X, 0.3);
  expect_derivative([&](double h) { return VectorXd(renderer.normals(cut.X + h * u).reshaped()); },
                    renderer.normal_derivative(cut.X) * u.reshaped(), 1e-3, 1e-8, "normals");
}

}  // namespace
}  // namespace hookeye
