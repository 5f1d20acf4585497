// Derivatives where no contour passes: pixel by pixel against differences of the picture.
#include "render/renderer.h"
#include "scene.h"
#include "support/derivative.h"

namespace hookeye {
namespace {

using test::expect_derivative;
using Source = Texture::Source;

struct Setting {
  Source source;
  const char* model;
  bool distorted, smooth;
};

std::string name_of(const testing::TestParamInfo<Setting>& info) {
  const Setting& s = info.param;
  std::string out = s.source == Source::image   ? "image"
                    : s.source == Source::photo ? "photo"
                                                : "uniform";
  out += std::string("_") + s.model;
  if (s.distorted) out += "_distorted";
  return out + (s.smooth ? "" : "_flat");
}

class Interior : public testing::TestWithParam<Setting> {
 protected:
  Interior()
      : surface(test::sphere(Vector3d::Zero(), 8, GetParam().smooth ? 4 : 0, 0.05)),
        renderer(surface),
        x(surface.X + 0.05 * test::field(surface.X, 0.7)),
        x_reference(surface.X),
        state(test::state(test::camera(GetParam().model, GetParam().distorted))) {
    texture.source = GetParam().source;
    texture.albedo = 0.8;
    texture.image = test::waves(1024, 1024, 4);
    if (GetParam().source == Source::photo) {
      texture.photo = test::waves(state.camera.width, state.camera.height, 3);
      texture.reference_camera = state.camera;
      texture.reference_gain = 1.2;
      state.shaded = false;
    }
    state.ambient = 0;  // see positions_where_facets_matter
    options.visibility_rays = 0;
    options.smooth_normals = GetParam().smooth;
  }

  Rendering render(const Matrix3Xd& at, const Matrix3Xd& reference, const PhotoState& photo,
                   bool derivatives) {
    RenderOptions o = options;
    o.derivatives = derivatives;
    return renderer.render(at, &reference, texture, photo, o, false);
  }
  /// Pixels well inside the body, where no step uncovers anything, and of flat facets those that
  /// see one of them alone, as their neighbours do; they pass the test one by one.
  void choose_pixels(const Rendering& r) {
    const Image& c = r.coverage;
    const test::Joined dI = test::joined(r.dI);
    std::vector<int> alone(c.pixels(), -1);
    for (size_t i = 0; i < dI.pixel.size(); ++i)
      if (dI.first[i + 1] == dI.first[i] + 1)
        alone[dI.pixel[i]] = dI.segments[dI.first[i]].triangle;
    r.dI.for_each_pixel([&](size_t, int px) {
      const int u = px % c.width, v = px / c.width;
      bool inside = u > 1 && v > 1 && u < c.width - 2 && v < c.height - 2;
      if (!GetParam().smooth)
        for (int near : {px, px - 1, px + 1, px - c.width, px + c.width})
          inside = inside && alone[px] >= 0 && alone[near] == alone[px];
      for (int dv = -2; inside && dv <= 2; ++dv)
        for (int du = -2; du <= 2; ++du) inside = inside && c.at(u + du, v + dv) == 1.0f;
      if (inside) pixels.push_back(px);
    });
    ASSERT_GT(pixels.size(), 250u);
  }
  VectorXd pick(const Image& image) const {
    VectorXd out(Eigen::Index(pixels.size()));
    for (size_t i = 0; i < pixels.size(); ++i) out[i] = image.values[pixels[i]];
    return out;
  }
  VectorXd pick(const VectorXd& all) const {
    VectorXd out(Eigen::Index(pixels.size()));
    for (size_t i = 0; i < pixels.size(); ++i) out[i] = all[pixels[i]];
    return out;
  }

  /// No motion of the reference state, where there is one.
  const Matrix3Xd* still() const {
    return GetParam().source == Source::photo ? &no_motion : nullptr;
  }

  SurfaceMesh surface;
  Renderer renderer;
  Matrix3Xd x, x_reference, no_motion = Matrix3Xd::Zero(3, surface.X.cols());
  PhotoState state;
  Texture texture;
  RenderOptions options;
  std::vector<int> pixels;
  /// Breaks of slope between texels; fewer pixels average them on flat facets.
  const double tolerance = GetParam().smooth ? 1e-3 : 2e-3;
};

/// Settings without jumps of intensity from facet to facet in the chosen pixels.
class SmoothInterior : public Interior {};
/// Settings whose texture is a photo of the body in a reference state.
class PhotoInterior : public Interior {};

TEST_P(SmoothInterior, positions) {
  const Rendering r = render(x, x_reference, state, true);
  choose_pixels(r);
  for (double phase : {0.0, 1.3}) {
    const Matrix3Xd u = test::field(surface.X, phase);
    const VectorXd analytic =
        pick(test::directional(renderer, r, x, &u, still(), VectorXd::Zero(kPhotoColumns)));
    expect_derivative(
        [&](double h) { return pick(render(x + h * u, x_reference, state, false).I); }, analytic,
        0.004, tolerance, "positions");
  }
}

// With interpolated normals the share of the sky that lies below a facet jumps at its edges. A ray
// that changes facets within the step measures that jump and not a derivative: with so small a step
// nine pixels in ten have none, and rounding of floats is 5e-3 of a derivative.
TEST_P(Interior, positions_where_facets_matter) {
  state.ambient = 0.4;
  const Rendering r = render(x, x_reference, state, true);
  choose_pixels(r);
  const Matrix3Xd u = test::field(surface.X, 0.5);
  const VectorXd analytic =
      pick(test::directional(renderer, r, x, &u, still(), VectorXd::Zero(kPhotoColumns)));
  const auto f = [&](double h) { return pick(render(x + h * u, x_reference, state, false).I); };
  const VectorXd numeric = (f(3e-4) - f(-3e-4)) / 6e-4;
  ASSERT_GT(numeric.cwiseAbs().mean(), 0);
  std::vector<double> error;
  for (int i = 0; i < numeric.size(); ++i) error.push_back(std::abs(numeric[i] - analytic[i]));
  const auto tenth = error.begin() + static_cast<std::ptrdiff_t>(error.size() * 9 / 10);
  std::nth_element(error.begin(), tenth, error.end());
  EXPECT_LT(*tenth, 6e-3 * numeric.cwiseAbs().mean());
}

TEST_P(PhotoInterior, reference) {
  const Rendering r = render(x, x_reference, state, true);
  choose_pixels(r);
  const Matrix3Xd u = test::field(surface.X, 0.4);
  const VectorXd analytic =
      pick(test::directional(renderer, r, x, nullptr, &u, VectorXd::Zero(kPhotoColumns)));
  expect_derivative([&](double h) { return pick(render(x, x_reference + h * u, state, false).I); },
                    analytic, 0.01, 1e-3, "reference");
}

TEST_P(SmoothInterior, photo_columns) {
  const Rendering r = render(x, x_reference, state, true);
  choose_pixels(r);
  for (int column = 0; column < kBlur; ++column) {
    const bool light = column >= kAmbient;
    if (light && !state.shaded) continue;
    if (column == kMove + 2 && !state.camera.model->central()) continue;
    // A uniform ball turned about the optical axis hardly changes: only breaks of slope remain.
    if (column == kRotate + 2 && GetParam().source == Source::uniform) continue;
    const VectorXd unit = VectorXd::Unit(kPhotoColumns, column);
    const auto f = [&](double h) {
      PhotoState s = state;
      if (column < kLogGain)
        s = test::with_camera(s, column, h);
      else if (column == kLogGain)
        s.gain *= std::exp(h);
      else if (column == kAmbient)
        s.ambient += h;
      else if (column < kSpecular)
        s.sun[column - kSun] += h;
      else
        s.specular += h;
      return pick(render(x, x_reference, s, false).I);
    };
    const double h = column < kMove || column == kZoom ? 1e-4 : column < kZoom ? 0.004 : 0.01;
    const VectorXd d = test::directional(renderer, r, x, nullptr, nullptr, unit);
    expect_derivative(f, pick(d), h, tolerance, "column " + std::to_string(column));
  }
}

/// Settings with light that is not in the texture.
class ShadedInterior : public Interior {
 protected:
  /// Brighter than nothing on every side.
  void light_unevenly() {
    state.ambient = 0.5;
    state.uneven << 0.2, -0.3, 0.1, 0.25, -0.15, 0.2, -0.1, 0.3;
    ASSERT_GT(Irradiance(state.ambient, state.uneven).least(), 0.1);
  }
};

TEST_P(ShadedInterior, uneven_light) {
  light_unevenly();
  const Rendering r = render(x, x_reference, state, true);
  choose_pixels(r);
  for (int k = -1; k < kUnevenNumbers; ++k) {
    const int column = k < 0 ? kAmbient : kUneven + k;
    const auto f = [&](double h) {
      PhotoState s = state;
      (k < 0 ? s.ambient : s.uneven[k]) += h;
      return pick(render(x, x_reference, s, false).I);
    };
    const VectorXd unit = VectorXd::Unit(kPhotoColumns, column);
    expect_derivative(f, pick(test::directional(renderer, r, x, nullptr, nullptr, unit)), 0.1, 1e-4,
                      "column " + std::to_string(column));
  }
}

/// By the number itself, and by what else changes a pixel's ray or what it meets.
TEST_P(ShadedInterior, vignetting) {
  if (!state.camera.model->central()) return;
  state.camera.vignetting = 2.5;
  const Rendering r = render(x, x_reference, state, true);
  choose_pixels(r);
  const auto check = [&](int column, double h, const auto& changed) {
    const auto f = [&](double by) { return pick(render(x, x_reference, changed(by), false).I); };
    const VectorXd unit = VectorXd::Unit(kPhotoColumns, column);
    expect_derivative(f, pick(test::directional(renderer, r, x, nullptr, nullptr, unit)), h,
                      tolerance, "column " + std::to_string(column));
  };
  check(kVignetting, 0.05, [&](double by) {
    PhotoState s = state;
    s.camera.vignetting += by;
    return s;
  });
  for (const int column : {kRotate + 1, kMove + 0, int(kZoom)})
    check(column, column == kMove ? 0.004 : 1e-4,
          [&](double by) { return test::with_camera(state, column, by); });
  const VectorXd dark = pick(r.I);
  state.camera.vignetting = 0.0;
  const VectorXd bright = pick(render(x, x_reference, state, true).I);
  EXPECT_LT(dark.sum(), 0.99 * bright.sum());
}

/// As positions_where_facets_matter, with nothing to see but the sky: facets and normals turn.
TEST_P(ShadedInterior, positions_under_uneven_light) {
  light_unevenly();
  state.sun.setZero();
  const Rendering r = render(x, x_reference, state, true);
  choose_pixels(r);
  const Matrix3Xd u = test::field(surface.X, 0.5);
  const auto f = [&](double h) { return pick(render(x + h * u, x_reference, state, false).I); };
  const VectorXd numeric = (f(3e-4) - f(-3e-4)) / 6e-4;
  const VectorXd analytic =
      pick(test::directional(renderer, r, x, &u, nullptr, VectorXd::Zero(kPhotoColumns)));
  ASSERT_GT(numeric.cwiseAbs().mean(), 0);
  std::vector<double> error;
  for (int i = 0; i < numeric.size(); ++i) error.push_back(std::abs(numeric[i] - analytic[i]));
  const auto tenth = error.begin() + static_cast<std::ptrdiff_t>(error.size() * 9 / 10);
  std::nth_element(error.begin(), tenth, error.end());
  // A body of one colour changes so little that rounding of its floats shows.
  const double rounding = std::exp2(-24) * 2 * pick(r.I).maxCoeff() / 6e-4;
  EXPECT_LT(*tenth, 6e-3 * numeric.cwiseAbs().mean() + rounding);
}

constexpr auto kPerspective = "perspective", kFisheye = "fisheye", kOrthographic = "orthographic";
const auto kPhotos = testing::Values(Setting{Source::photo, kPerspective, false, true},
                                     Setting{Source::photo, kPerspective, true, true},
                                     Setting{Source::photo, kFisheye, true, true},
                                     Setting{Source::photo, kOrthographic, false, true});
const auto kShaded = testing::Values(Setting{Source::image, kPerspective, false, true},
                                     Setting{Source::image, kPerspective, true, true},
                                     Setting{Source::image, kFisheye, false, true},
                                     Setting{Source::image, kFisheye, true, true},
                                     Setting{Source::image, kOrthographic, false, true},
                                     Setting{Source::image, kOrthographic, true, true},
                                     Setting{Source::uniform, kPerspective, false, true},
                                     Setting{Source::uniform, kOrthographic, false, true},
                                     Setting{Source::uniform, kPerspective, true, true});
INSTANTIATE_TEST_SUITE_P(photo, PhotoInterior, kPhotos, name_of);
INSTANTIATE_TEST_SUITE_P(photo, SmoothInterior, kPhotos, name_of);
INSTANTIATE_TEST_SUITE_P(shaded, SmoothInterior, kShaded, name_of);
INSTANTIATE_TEST_SUITE_P(photo, Interior, kPhotos, name_of);
INSTANTIATE_TEST_SUITE_P(shaded, Interior, kShaded, name_of);
const auto kFlat = testing::Values(Setting{Source::image, kPerspective, false, false});
INSTANTIATE_TEST_SUITE_P(flat, SmoothInterior, kFlat, name_of);
INSTANTIATE_TEST_SUITE_P(shaded, ShadedInterior, kShaded, name_of);
INSTANTIATE_TEST_SUITE_P(flat, ShadedInterior, kFlat, name_of);

TEST(normals, derivative) {
  const SurfaceMesh surface = test::sphere(Vector3d::Zero(), 8, 1, 0.2);
  const Renderer renderer(surface);
  const Matrix3Xd u = test::field(surface.X, 0.3);
  expect_derivative(
      [&](double h) { return VectorXd(renderer.normals(surface.X + h * u).reshaped()); },
      renderer.normal_derivative(surface.X) * u.reshaped(), 1e-3, 1e-8, "normals");
}

}  // namespace
}  // namespace hookeye
