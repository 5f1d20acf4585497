// Files of cv::FileStorage: one camera, or two with the pose of the second.
//
// cv::stereoCalibrate: x_in_2 = R x_in_1 + T; pixels by OpenCV's camera matrix and distortion, the
// centre of the first pixel is (0, 0). OpenCV's sample writes M1 D1 M2 D2 into intrinsics.yml and R
// T into extrinsics.yml.
#include <fmt/format.h>

#include <algorithm>

#include "capture_io/stored_camera.h"
#include "importers/detail.h"

namespace hookeye {
namespace {

const StoredKeys kFirst{{"M1", "K1", "cameraMatrix1", "camera_matrix_1"},
                        {"D1", "distCoeffs1", "dist_coeffs_1", "distortion_coefficients_1"}};
const StoredKeys kSecond{{"M2", "K2", "cameraMatrix2", "camera_matrix_2"},
                         {"D2", "distCoeffs2", "dist_coeffs_2", "distortion_coefficients_2"}};

/// cv::fisheye's four numbers look like OpenCV's first four.
void tell_of_fisheyes(const Camera& camera, Imported& out) {
  if (camera.distortion.size() == 4 && camera.model->name() == "perspective")
    out.said.push_back(fmt::format(
        "`{}` has four distortion coefficients and does not say which lens: they are taken as k1 "
        "k2 "
        "p1 p2. If cv::fisheye made them, write `projection: fisheye` for it in cameras.yaml",
        camera.name));
}

class OpenCv final : public Importer {
 public:
  std::string name() const override { return "opencv"; }
  std::string title() const override {
    return "calibration by OpenCV (yml, xml, json): one camera, or M1 D1 M2 D2 R T";
  }

  bool recognises(const Sources& sources) const override {
    return std::all_of(sources.begin(), sources.end(), [](const auto& file) {
      const std::string head = detail::head_of(file);
      return detail::has_ending(file, {".yml", ".yaml", ".xml", ".json"}) &&
             (head.starts_with("%yaml") || head.find("opencv") != std::string::npos ||
              head.find("camera_matrix") != std::string::npos);
    });
  }

  Imported read(const Sources& sources, const ImportOptions&) const override {
    std::vector<StoredFile> files;
    for (const auto& source : sources) files.emplace_back(source);
    for (const StoredFile& file : files)
      if (file.find(kSecond.matrix)) return stereo(file, files);
    Imported out;
    for (size_t i = 0; i < files.size(); ++i) {
      Camera camera = stored_camera(files[i]);
      camera.name = sources[i].stem().string();
      const bool posed = read_stored_pose(files[i], camera);
      if (!posed && files.size() > 1)
        files[i].fail(fmt::format("where `{}` stands is not in it", camera.name),
                      "give R and T (world to camera), or calibrate the cameras as a pair");
      out.world = posed ? "the frame of R and T" : "the axes of " + camera.name;
      tell_of_fisheyes(camera, out);
      out.cameras.push_back(std::move(camera));
    }
    return out;
  }

 private:
  static Imported stereo(const StoredFile& intrinsics, const std::vector<StoredFile>& files) {
    Imported out;
    out.cameras = {stored_camera(intrinsics, kFirst), stored_camera(intrinsics, kSecond)};
    out.cameras[0].name = "cam1", out.cameras[1].name = "cam2";
    bool posed = false;
    for (const StoredFile& file : files)
      if (!posed) posed = read_stored_pose(file, out.cameras[1]);
    if (!posed)
      intrinsics.fail("it has two cameras and not their pose, `R` and `T`",
                      "name the file with the extrinsics behind it");
    for (const Camera& camera : out.cameras) tell_of_fisheyes(camera, out);
    out.world = "the axes of cam1";
    return out;
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_IMPORTER(opencv, OpenCv)
