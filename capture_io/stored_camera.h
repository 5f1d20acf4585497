// A camera in a file that cv::FileStorage wrote.
#pragma once

#include "capture_io/camera.h"
#include "capture_io/file_storage.h"

namespace hookeye {

/// The keys under which a camera may stand, the first that is there counts.
struct StoredKeys {
  std::vector<std::string> matrix{"camera_matrix",    "K", "cameraMatrix", "Camera_Matrix",
                                  "intrinsic_matrix", "M1"};
  std::vector<std::string> distortion{"distortion_coefficients", "D", "distCoeffs", "dist_coeffs",
                                      "Distortion_Coefficients", "D1"};
};

/// Intrinsics, lens and, where it is there, size; throws InputError.
Camera stored_camera(const StoredFile& from, const StoredKeys& keys = {});
/// R (matrix or rotation vector) and T, world to camera; false where the file has neither.
bool read_stored_pose(const StoredFile& from, Camera& camera);

}  // namespace hookeye
