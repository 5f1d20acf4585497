// Agisoft Metashape, written as its manual says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/text_file.h"
#include "importers/published.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

std::string numbers_in(const Eigen::MatrixXd& m) {
  std::string out;
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.cols(); ++j) out += fmt::format("{:.17g} ", m(i, j));
  return out;
}

/// The world's pose of the chunk: x_in_world = s R x_in_chunk + t.
const double kScale = 2.5;
const Matrix3d kTurn = turn({0.2, 1, -0.4}, 1.1);
const Vector3d kShift(3, -2, 5);

/// <transform> of a camera that stands in the world as `pose` says.
std::string camera_to_chunk(const Pose& pose) {
  Eigen::Matrix4d M = Eigen::Matrix4d::Identity();
  const Vector3d centre = -pose.R.transpose() * pose.t;
  M.topLeftCorner<3, 3>() = kTurn.transpose() * pose.R.transpose();
  M.topRightCorner<3, 1>() = kTurn.transpose() * (centre - kShift) / kScale;
  return "<transform>" + numbers_in(M) + "</transform>\n";
}

std::string document(const std::string& type, const std::string& lens, const std::string& cameras,
                     bool scaled = true) {
  const std::string chunk = scaled
                                ? "<transform><rotation locked=\"true\">" + numbers_in(kTurn) +
                                      "</rotation><translation>" + numbers_in(kShift.transpose()) +
                                      "</translation><scale>2.5</scale></transform>\n"
                                : "";
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document version=\"2.0.0\">\n"
         "  <chunk label=\"Chunk 1\" enabled=\"true\">\n    <sensors next_id=\"1\">\n"
         "      <sensor id=\"0\" label=\"unknown\" type=\"" +
         type +
         "\">\n<resolution width=\"640\" height=\"480\"/>\n"
         "<calibration type=\"" +
         type +
         "\" class=\"initial\"><resolution width=\"640\" height=\"480\"/><f>900</f>"
         "</calibration>\n<calibration type=\"" +
         type + "\" class=\"adjusted\">\n<resolution width=\"640\" height=\"480\"/>\n<f>700</f>\n" +
         lens +
         "</calibration>\n</sensor>\n</sensors>\n<components next_id=\"1\">\n"
         "<component id=\"0\" label=\"Component 1\">\n" +
         chunk + "</component></components>\n<cameras next_id=\"2\">\n" + cameras +
         "</cameras>\n<reference>LOCAL_CS[\"Local\"]</reference>\n</chunk>\n</document>\n";
}

std::string camera(const std::string& label, const std::string& transform) {
  return "<camera id=\"0\" sensor_id=\"0\" component_id=\"0\" label=\"" + label + "\">\n" +
         transform + "</camera>\n";
}

const std::string kOffsets = "<cx>5.5</cx>\n<cy>-3.25</cy>\n<b1>4</b1>\n<b2>-1.5</b2>\n";
const std::string kRadial = "<k1>-0.1</k1>\n<k2>0.04</k2>\n<k3>0.02</k3>\n";

/// u = w/2 + cx + x' f + x' B1 + y' B2, v = h/2 + cy + y' f, less half a pixel.
Vector2d to_pixel(double x, double y) {
  return {320 + 5.5 + 704 * x - 1.5 * y - 0.5, 240 - 3.25 + 700 * y - 0.5};
}

TEST(MetashapeImport, ProjectsAsItsManualSays) {
  const TemporaryFolder folder;
  const auto file = folder / "cameras.xml";
  const Pose pose = some_pose();
  write_text(file, document("frame", kOffsets + kRadial + "<p1>0.001</p1>\n<p2>-0.002</p2>\n",
                            camera("IMG_1.JPG", camera_to_chunk(pose)) + camera("IMG_2.JPG", "")));
  EXPECT_EQ(recognise({file}).name(), "metashape");
  const Imported imported = import_from("metashape", {file});
  ASSERT_EQ(imported.cameras.size(), 1u);
  EXPECT_THAT(imported.said, testing::ElementsAre(HasSubstr("1 photos that are not aligned")));
  expect_projects(imported, "IMG_1", pose, [](const Vector3d& X) {
    const double x = X.x() / X.z(), y = X.y() / X.z(), r2 = x * x + y * y;
    const double radial = 1 - 0.1 * r2 + 0.04 * r2 * r2 + 0.02 * r2 * r2 * r2;
    const double P1 = 0.001, P2 = -0.002;
    return to_pixel(x * radial + P1 * (r2 + 2 * x * x) + 2 * P2 * x * y,
                    y * radial + P2 * (r2 + 2 * y * y) + 2 * P1 * x * y);
  });
}

TEST(MetashapeImport, FisheyesAreOfTheAngle) {
  const TemporaryFolder folder;
  const auto file = folder / "cameras.xml";
  const Pose pose = some_pose();
  write_text(file, document("fisheye", kOffsets + "<k1>0.02</k1><k2>-0.01</k2><k4>0.003</k4>",
                            camera("IMG_1.JPG", camera_to_chunk(pose))));
  expect_projects(import_from("metashape", {file}), "IMG_1", pose, [](const Vector3d& X) {
    const double r = std::hypot(X.x(), X.y()), angle = std::atan2(r, X.z()), a2 = angle * angle;
    const double bent = angle * (1 + 0.02 * a2 - 0.01 * a2 * a2 + 0.003 * std::pow(a2, 4));
    return to_pixel(bent * X.x() / r, bent * X.y() / r);
  });
}

TEST(MetashapeImport, AChunkWithoutScaleIsSaid) {
  const TemporaryFolder folder;
  const auto file = folder / "cameras.xml";
  write_text(file, document("frame", kRadial, camera("a", camera_to_chunk(some_pose())), false));
  EXPECT_THAT(import_from("metashape", {file}).said,
              testing::ElementsAre(HasSubstr("the chunk has no scale")));
}

TEST(MetashapeImport, FaultsHaveTheirLine) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& text) {
    write_text(folder / "cameras.xml", text);
    return complaint(folder.path(), [&] { import_from("metashape", {folder / "cameras.xml"}); });
  };
  const std::string one = camera("a", camera_to_chunk(some_pose()));
  EXPECT_EQ(refused(document("frame", "<k4>0.1</k4>\n", one)),
            "cameras.xml:8: k4 is not zero\n  optimise the cameras without k4");
  EXPECT_EQ(refused(document("fisheye", "<p1>0.1</p1>\n", one)),
            "cameras.xml:8: a fisheye has p1 or p2\n  optimise the cameras without p1 and p2");
  EXPECT_EQ(refused(document("spherical", "", one)),
            "cameras.xml:8: cameras of type `spherical` are not read\n  frame or fisheye");
  EXPECT_THAT(refused(document("frame", "", camera("a", "<transform>1 2 x</transform>\n"))),
              HasSubstr("`x` is no number"));
  EXPECT_THAT(refused(document("frame", "", camera("a", ""))),
              HasSubstr("cameras.xml:3: there is no aligned camera"));
  const std::string whole = document("frame", kRadial, one);
  EXPECT_THAT(refused(whole.substr(0, whole.size() / 2)), HasSubstr("cameras.xml:"));
}

}  // namespace
}  // namespace hookeye::test
