// COLMAP's sparse model, as text and binary, and transforms.json, written as their documents say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <vector>

#include "core/text_file.h"
#include "importers/published.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

struct ColmapKind {
  int number;
  const char* name;
  std::vector<double> parameters;
  std::function<Vector2d(const Vector3d&)> plane;
  int focals;
};

const std::vector<ColmapKind>& kinds() {
  static const std::vector<ColmapKind> all = {
      {0, "SIMPLE_PINHOLE", {700, 322, 243}, [](const Vector3d& x) { return brown(x, {}); }, 1},
      {1, "PINHOLE", {700, 710, 322, 243}, [](const Vector3d& x) { return brown(x, {}); }, 2},
      {2,
       "SIMPLE_RADIAL",
       {700, 322, 243, -0.1},
       [](const Vector3d& x) { return brown(x, {-0.1}); },
       1},
      {3,
       "RADIAL",
       {700, 322, 243, -0.1, 0.04},
       [](const Vector3d& x) {
         return brown(x, {-0.1, 0.04});
       },
       1},
      {4,
       "OPENCV",
       {700, 710, 322, 243, -0.1, 0.04, 0.001, -0.002},
       [](const Vector3d& x) {
         return brown(x, {-0.1, 0.04, 0.001, -0.002});
       },
       2},
      {5,
       "OPENCV_FISHEYE",
       {700, 710, 322, 243, 0.02, -0.01, 0.004, -0.001},
       [](const Vector3d& x) {
         return equidistant(x, {0.02, -0.01, 0.004, -0.001});
       },
       2},
      {6,
       "FULL_OPENCV",
       {700, 710, 322, 243, -0.1, 0.04, 0.001, -0.002, 0.02, 0.05, 0.01, 0.003},
       [](const Vector3d& x) {
         return brown(x, {-0.1, 0.04, 0.001, -0.002, 0.02, 0.05, 0.01, 0.003});
       },
       2},
      {8,
       "SIMPLE_RADIAL_FISHEYE",
       {700, 322, 243, 0.02},
       [](const Vector3d& x) { return equidistant(x, {0.02}); },
       1},
      {9,
       "RADIAL_FISHEYE",
       {700, 322, 243, 0.02, -0.01},
       [](const Vector3d& x) {
         return equidistant(x, {0.02, -0.01});
       },
       1}};
  return all;
}

/// COLMAP's own pixel: the first one's centre is (0.5, 0.5).
Vector2d colmap_pixel(const ColmapKind& kind, const Vector3d& in_camera) {
  const Vector2d p = kind.plane(in_camera);
  const std::vector<double>& k = kind.parameters;
  const auto f = static_cast<size_t>(kind.focals);
  return {k[0] * p.x() + k[f], k[f - 1] * p.y() + k[f + 1]};
}

Pose pose_of(size_t i) {
  return {turn({1, 0.3 * static_cast<double>(i), 0.5}, 0.3 + 0.2 * static_cast<double>(i)),
          {0.1 * static_cast<double>(i), -0.2, 0.9}};
}

/// w x y z, by the half angle.
Eigen::Vector4d quaternion(const Matrix3d& R) {
  const double w = std::sqrt(1 + R.trace()) / 2;
  return {w, (R(2, 1) - R(1, 2)) / (4 * w), (R(0, 2) - R(2, 0)) / (4 * w),
          (R(1, 0) - R(0, 1)) / (4 * w)};
}

/// One camera a kind, one image a camera, which sees its 100 points.
void write_text_model(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::ofstream cameras(folder / "cameras.txt"), images(folder / "images.txt"),
      points(folder / "points3D.txt");
  for (std::ofstream* out : {&cameras, &images, &points})
    *out << "# a comment\n", out->precision(17);
  for (size_t i = 0; i < kinds().size(); ++i) {
    const ColmapKind& kind = kinds()[i];
    cameras << i + 1 << " " << kind.name << " 640 480";
    for (const double p : kind.parameters) cameras << " " << p;
    cameras << "\n";
    const Pose pose = pose_of(i);
    images << i + 1 << " " << quaternion(pose.R).transpose() << " " << pose.t.transpose() << " "
           << i + 1 << " photos/" << kind.name << ".jpg\n0.5 0.5 -1";
    const std::vector<Vector3d> x = points_before(pose);
    for (size_t n = 0; n < x.size(); ++n) {
      images << " " << colmap_pixel(kind, pose.R * x[n] + pose.t).transpose() << " "
             << 1000 * i + n;
      points << 1000 * i + n << " " << x[n].transpose() << " 9 9 9 0.1 " << i + 1 << " " << n + 1
             << "\n";
    }
    images << "\n";
  }
}

class Bytes {
 public:
  explicit Bytes(const std::filesystem::path& file) : out_(file, std::ios::binary) {}
  template <class T>
  Bytes& put(T value) {
    out_.write(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Bytes& text(const std::string& value) {
    out_.write(value.c_str(), static_cast<std::streamsize>(value.size() + 1));
    return *this;
  }

 private:
  std::ofstream out_;
};

void write_binary_model(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  Bytes cameras(folder / "cameras.bin"), images(folder / "images.bin"),
      points(folder / "points3D.bin");
  const uint64_t count = kinds().size();
  cameras.put(count), images.put(count), points.put(100 * count);
  for (uint32_t i = 0; i < count; ++i) {
    const ColmapKind& kind = kinds()[i];
    cameras.put(i + 1).put(int32_t{kind.number}).put(uint64_t{640}).put(uint64_t{480});
    for (const double p : kind.parameters) cameras.put(p);
    const Pose pose = pose_of(i);
    const Eigen::Vector4d q = quaternion(pose.R);
    images.put(i + 1);
    for (int k = 0; k < 4; ++k) images.put(q[k]);
    for (int k = 0; k < 3; ++k) images.put(pose.t[k]);
    images.put(i + 1).text(std::string("photos/") + kind.name + ".jpg").put(uint64_t{101});
    images.put(0.5).put(0.5).put(UINT64_MAX);
    const std::vector<Vector3d> x = points_before(pose);
    for (size_t n = 0; n < x.size(); ++n) {
      const Vector2d pixel = colmap_pixel(kind, pose.R * x[n] + pose.t);
      images.put(pixel.x()).put(pixel.y()).put(uint64_t{1000 * i + n});
      points.put(uint64_t{1000 * i + n}).put(x[n].x()).put(x[n].y()).put(x[n].z());
      for (int k = 0; k < 3; ++k) points.put(uint8_t{9});
      points.put(0.1).put(uint64_t{1}).put(i + 1).put(static_cast<uint32_t>(n + 1));
    }
  }
}

class ColmapImport : public testing::TestWithParam<bool> {};

TEST_P(ColmapImport, EveryModelProjectsAsItsDocumentSays) {
  const TemporaryFolder folder;
  (GetParam() ? write_binary_model : write_text_model)(folder / "project/sparse/0");
  EXPECT_EQ(recognise({folder / "project"}).name(), "colmap");
  const Imported imported = import_from("colmap", {folder / "project"});
  ASSERT_EQ(imported.cameras.size(), kinds().size());
  for (size_t i = 0; i < kinds().size(); ++i) {
    const ColmapKind& kind = kinds()[i];
    expect_projects(imported, kind.name, pose_of(i), [&](const Vector3d& x) {
      return Vector2d(colmap_pixel(kind, x) - Vector2d(0.5, 0.5));
    });
  }
  for (const Reprojection& of : reproject(imported)) {
    EXPECT_EQ(of.points, 100u);
    EXPECT_LT(of.rms_px, 0.01);
  }
  // In other lengths it stays what it is.
  const Imported scaled = import_from("colmap", {folder / "project"}, {0, 0, 250.0});
  EXPECT_LT(reproject(scaled)[4].rms_px, 0.01);
  EXPECT_NEAR(camera_of(scaled, "OPENCV").centre().norm(),
              250 * camera_of(imported, "OPENCV").centre().norm(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Formats, ColmapImport, testing::Bool());

TEST(ColmapFaults, OfTextHaveTheirLine) {
  const TemporaryFolder folder;
  const auto told = [&](const char* file, const std::string& from, const std::string& to) {
    write_text_model(folder / "m");
    std::string text = read_text(folder / "m" / file);
    text.replace(text.find(from), from.size(), to);
    write_text(folder / "m" / file, text);
    return complaint(folder / "m", [&] { import_from("colmap", {folder / "m"}); });
  };
  const std::string wrote =
      "\n  the files as COLMAP wrote them (colmap model_converter --output_type TXT)";
  EXPECT_THAT(told("cameras.txt", "SIMPLE_RADIAL 640", "FOV 640"),
              testing::StartsWith("cameras.txt:4: camera model FOV is none that a capture can "
                                  "express\n  convert it"));
  EXPECT_THAT(told("cameras.txt", "SIMPLE_RADIAL 640", "NEW_ONE 640"),
              testing::StartsWith("cameras.txt:4: camera model NEW_ONE is not known"));
  EXPECT_EQ(told("cameras.txt", "700 322 243\n", "700 322\n"),
            "cameras.txt:2: SIMPLE_PINHOLE has 2 parameters\n  3 of them");
  EXPECT_EQ(told("images.txt", " 1 photos/", " one photos/"),
            "images.txt:2: `one` is no number of a camera" + wrote);
  EXPECT_EQ(told("images.txt", " 1 photos/", " 77 photos/"),
            "images.txt:2: cameras.txt has no camera 77\n  files of one model");
  EXPECT_EQ(
      told("images.txt", "0.5 0.5 -1", "0.5 0.5"), "images.txt:3: `" + [] {
        std::ostringstream pixel;
        pixel.precision(17);
        const Vector3d x = points_before(pose_of(0))[0];
        pixel << colmap_pixel(kinds()[0], pose_of(0).R * x + pose_of(0).t).x();
        return pixel.str();
      }() + "` is no number of a point" + wrote);
}

TEST(ColmapNames, MayHoldBlanks) {
  const TemporaryFolder folder;
  write_text_model(folder / "m");
  std::string text = read_text(folder / "m/images.txt");
  const std::string from = "photos/PINHOLE.jpg";
  text.replace(text.find(from), from.size(), "cam 1/my photo.jpg");
  write_text(folder / "m/images.txt", text);
  EXPECT_EQ(camera_of(import_from("colmap", {folder / "m"}), "my_photo").fy, 710);
}

/// Cut anywhere a binary model is refused, and by the name of its file.
TEST(ColmapFaults, TruncatedBinariesAreRefused) {
  const TemporaryFolder folder;
  write_binary_model(folder / "m");
  for (const char* file : {"cameras.bin", "images.bin", "points3D.bin"}) {
    const std::string whole = read_text(folder / "m" / file);
    for (const size_t cut : {size_t{3}, whole.size() / 3, whole.size() - 1}) {
      std::ofstream(folder / "m" / file, std::ios::binary) << whole.substr(0, cut);
      EXPECT_THAT(complaint(folder / "m", [&] { import_from("colmap", {folder / "m"}); }),
                  testing::StartsWith(file))
          << cut;
    }
    std::ofstream(folder / "m" / file, std::ios::binary) << whole;
  }
}

std::string rows_of(const Eigen::Matrix4d& M) {
  std::string text;
  for (int i = 0; i < 4; ++i) text += (i ? ", " : "[") + list(M.row(i));
  return text + "]";
}

/// Camera to world, in OpenGL's axes: x right, y up, z back.
Eigen::Matrix4d opengl_pose(const Pose& pose) {
  const Matrix3d gl_from_cv = Vector3d(1, -1, -1).asDiagonal();
  Eigen::Matrix4d M = Eigen::Matrix4d::Identity();
  M.topLeftCorner<3, 3>() = (gl_from_cv * pose.R).transpose();
  M.topRightCorner<3, 1>() = -pose.R.transpose() * pose.t;
  return M;
}

TEST(TransformsImport, ProjectsAsItsDocumentSays) {
  const TemporaryFolder folder;
  const Pose first = some_pose(), second = pose_of(2);
  write_text(folder / "transforms.json",
             R"({"fl_x": 700, "fl_y": 710, "cx": 322, "cy": 243, "w": 640, "h": 480, "k1": -0.1,
 "k2": 0.04, "p1": 0.001, "p2": -0.002, "camera_model": "OPENCV", "frames": [
 {"file_path": "images/a.jpg", "transform_matrix": )" +
                 rows_of(opengl_pose(first)) +
                 R"(}, {"file_path": "images/b.jpg", "camera_model": "OPENCV_FISHEYE", "k1": 0.02,
 "k2": -0.01, "p1": 0, "p2": 0, "transform_matrix": )" +
                 rows_of(opengl_pose(second)) + "}]}");
  EXPECT_EQ(recognise({folder / "transforms.json"}).name(), "transforms");
  const Imported imported = import_from("transforms", {folder / "transforms.json"});
  const auto pixel = [](const Vector2d& p) {
    return Vector2d(700 * p.x() + 322 - 0.5, 710 * p.y() + 243 - 0.5);
  };
  expect_projects(imported, "a", first, [&](const Vector3d& x) {
    return pixel(brown(x, {-0.1, 0.04, 0.001, -0.002}));
  });
  expect_projects(imported, "b", second, [&](const Vector3d& x) {
    return pixel(equidistant(x, {0.02, -0.01}));
  });
}

/// Blender's exporters tell the field of view alone: half the width is seen at half the angle.
TEST(TransformsImport, AFieldOfViewIsAFocalLength) {
  const TemporaryFolder folder;
  write_text(folder / "t.json", R"({"camera_angle_x": 0.8, "w": 800, "h": 600, "frames": [
 {"file_path": "./r_0", "transform_matrix": )" +
                                    rows_of(opengl_pose({})) + "}]}");
  const Imported imported = import_from("transforms", {folder / "t.json"});
  const Camera& camera = camera_of(imported, "r_0");
  // The picture's right edge, behind the last pixel's centre by half a pixel.
  EXPECT_NEAR(camera.project({std::tan(0.4), 0, 1}).x(), 799.5, 1e-9);
  EXPECT_NEAR(camera.project({0, 0, 1}).y(), 299.5, 1e-9);
  EXPECT_EQ(camera.fx, camera.fy);
}

TEST(TransformsImport, FaultsAreNamed) {
  const TemporaryFolder folder;
  const auto told = [&](const std::string& head, const std::string& pose) {
    write_text(folder / "t.json", "{" + head + R"("frames": [{"file_path": "a.png", )" +
                                      "\"transform_matrix\": " + pose + "}]}");
    return complaint(folder.path(), [&] { import_from("transforms", {folder / "t.json"}); });
  };
  const std::string size = R"("w": 640, "h": 480, )", focal = size + R"("fl_x": 700, )";
  const std::string here = rows_of(opengl_pose({}));
  EXPECT_EQ(told(focal, here), "");
  EXPECT_EQ(told("", here),
            "t.json: frame 0: the picture size `w`, `h` is 0 x 0\n"
            "  write \"w\" and \"h\" of the photos [px] at the top of the file");
  EXPECT_EQ(told(size, here),
            "t.json: frame 0: there is no focal length\n  `fl_x` [px], or `camera_angle_x` [rad]");
  EXPECT_EQ(told(focal + R"("k4": 0.1, )", here),
            "t.json: frame 0: `k4` is not zero, and no camera of a capture has this term\n"
            "  calibrate with k1, k2, k3, p1, p2");
  EXPECT_EQ(told(focal + R"("camera_model": "EQUIRECTANGULAR", )", here),
            "t.json: frame 0: camera_model is `EQUIRECTANGULAR`\n"
            "  OPENCV, PINHOLE, SIMPLE_PINHOLE or OPENCV_FISHEYE is read");
  EXPECT_EQ(told(focal, "[[1, 0], [0, 1]]"),
            "t.json: frame 0: transform_matrix is no map of space\n  four rows of four numbers");
  EXPECT_EQ(told(focal, "5"),
            "t.json: frame 0: there is no `transform_matrix`\n  four rows of four numbers");
  write_text(folder / "t.json", R"({"frames": [)");
  EXPECT_THAT(complaint(folder.path(), [&] { import_from("transforms", {folder / "t.json"}); }),
              testing::HasSubstr("damaged"));
}

}  // namespace
}  // namespace hookeye::test
