// A body's picture lies where the camera projects the body to, for every camera of the catalogue.
#include <gtest/gtest.h>

#include "render/renderer.h"
#include "scene.h"

namespace hookeye {
namespace {

/// Area, centroid and extent of a picture's body [px].
struct Outline {
  double area = 0;
  Vector2d centre = Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();  ///< about the centre, over the area
};

/// Of the coverage of all pixels.
Outline of_picture(const Image& coverage) {
  Outline out;
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (int y = 0; y < coverage.height; ++y)
    for (int x = 0; x < coverage.width; ++x) {
      const double share = coverage.at(x, y);
      const Vector2d at(x, y);
      out.area += share, out.centre += share * at, sum += share * at * at.transpose();
    }
  out.centre /= out.area;
  out.second = sum / out.area - out.centre * out.centre.transpose();
  return out;
}

/// Of the projected triangles that a convex body turns to the camera.
Outline of_projection(const Camera& camera, const SurfaceMesh& body) {
  Outline out;
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (const auto& t : body.triangles) {
    const Vector2d a = camera.project(body.X.col(t[0])), b = camera.project(body.X.col(t[1])),
                   c = camera.project(body.X.col(t[2]));
    const Vector2d u = b - a, v = c - a, middle = (a + b + c) / 3;
    const double area = -(u.x() * v.y() - u.y() * v.x()) / 2;
    if (!(area > 0)) continue;
    out.area += area, out.centre += area * middle;
    // The mean of x x^T over a triangle.
    sum += area * (0.75 * middle * middle.transpose() +
                   (a * a.transpose() + b * b.transpose() + c * c.transpose()) / 12);
  }
  out.centre /= out.area;
  out.second = sum / out.area - out.centre * out.centre.transpose();
  return out;
}

/// Looks along z; the picture has room for what a fisheye sees 80 degrees off its axis.
Camera camera_of(const CameraModel& model, bool distorted) {
  Camera camera = test::camera(model.name(), distorted);
  camera.R.setIdentity(), camera.t.setZero();
  camera.width = 180, camera.height = 140;
  camera.cx = 70, camera.cy = 60;
  if (model.name() != "fisheye") return camera;
  camera = camera.resized(3);
  camera.width *= 3, camera.height *= 3;
  return camera;
}

/// An egg before it; before a fisheye 62 to 80 degrees off the axis, so that the corners of the
/// picture have no rays at all.
SurfaceMesh body_before(const CameraModel& model) {
  const Vector3d centre = model.name() == "fisheye"        ? Vector3d(52, 34, 20)
                          : model.name() == "orthographic" ? Vector3d(12, 8, 50)
                                                           : Vector3d(10, 7, 45);
  SurfaceMesh body = test::sphere(centre, 7, 5);
  body.X.row(0) = (1.3 * (body.X.row(0).array() - centre.x()) + centre.x()).matrix();
  return body;
}

TEST(CameraModels, PicturesLieWhereTheBodyIsProjected) {
  for (const CameraModel* model : camera_models())
    for (const bool distorted : {false, true}) {
      const std::string what = model->name() + (distorted ? ", distorted" : "");
      const SurfaceMesh body = body_before(*model);
      const PhotoState state = test::state(camera_of(*model, distorted));
      Texture texture;
      texture.source = Texture::Source::uniform;
      RenderOptions options;
      options.derivatives = false;
      options.visibility_rays = 0;
      options.rays_per_axis = 8;
      Renderer renderer(body);
      const Outline seen =
          of_picture(renderer.render(body.X, nullptr, texture, state, options, true).coverage);
      const Outline told = of_projection(state.camera, body);
      ASSERT_GT(told.area, 300) << what;
      EXPECT_NEAR(seen.area, told.area, 2e-3 * told.area) << what;
      EXPECT_LT((seen.centre - told.centre).norm(), 0.02) << what;
      // The filter of the pixels spreads the picture by the same in all directions.
      const Eigen::Matrix2d spread = seen.second - told.second;
      const double tolerance = 1e-3 * told.second.trace();
      EXPECT_NEAR(spread(0, 0), spread(1, 1), tolerance) << what;
      EXPECT_NEAR(spread(0, 1), 0, tolerance) << what;
      EXPECT_LT(spread.cwiseAbs().maxCoeff(), 0.5) << what;
    }
}

TEST(CameraModels, CornersWithoutRaysShowTheBackground) {
  const CameraModel& fisheye = camera_model("fisheye");
  const SurfaceMesh body = body_before(fisheye);
  const PhotoState state = test::state(camera_of(fisheye, false));
  const int width = state.camera.width, height = state.camera.height;
  ASSERT_TRUE(state.camera.ray({width - 1.0, height - 1.0}).direction.hasNaN());
  Renderer renderer(body);
  const Rendering r = renderer.render(body.X, nullptr, Texture{}, state, RenderOptions(), true);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      ASSERT_TRUE(std::isfinite(r.I.at(x, y)));
      if (!state.camera.ray({double(x), double(y)}).direction.hasNaN()) continue;
      EXPECT_EQ(r.coverage.at(x, y), 0) << x << " " << y;
    }
  r.dI.for_each_pixel([&](size_t, int pixel) {
    EXPECT_FALSE(
        state.camera.ray({double(pixel % width), double(pixel / width)}).direction.hasNaN());
  });
}

}  // namespace
}  // namespace hookeye
