// cameras.bin, images.bin and points3D.bin: little-endian, counts of 64 bits before what they
// count.
#include <fmt/format.h>

#include "importers/colmap_model.h"
#include "meshing/file_cursor.h"

namespace hookeye::detail {
namespace {

namespace fs = std::filesystem;

const char* const kWholeModel = "the files as COLMAP wrote them";

Eigen::VectorXd reals(FileCursor& file, Eigen::Index count) {
  Eigen::VectorXd out(count);
  for (Eigen::Index i = 0; i < count; ++i) out[i] = file.number<double>();
  if (!out.allFinite()) file.fault("a number is not finite", kWholeModel, true);
  return out;
}

/// Up to its zero byte.
std::string text(FileCursor& file) {
  const size_t end = file.rest().find('\0');
  if (end == std::string_view::npos) file.ends();
  std::string out(file.rest().substr(0, end));
  file.skip(end + 1);
  return out;
}

void expect_end(const FileCursor& file) {
  if (!file.rest().empty())
    file.fault(fmt::format("{} bytes are left over", file.rest().size()), kWholeModel, true);
}

void read_cameras_bin(const fs::path& path, ColmapModel& model) {
  FileCursor file(path);
  for (auto n = file.number<uint64_t>(); n > 0; --n) {
    const auto id = file.number<uint32_t>();
    const auto number = file.number<int32_t>();
    const auto width = file.number<uint64_t>(), height = file.number<uint64_t>();
    const ColmapCameraKind kind = colmap_camera_kind(number);
    if (kind.parameters == 0)
      file.fault(fmt::format("camera model number {} is not known", number),
                 "colmap model_converter --output_type TXT tells its name", true);
    const Eigen::VectorXd p = reals(file, static_cast<Eigen::Index>(kind.parameters));
    if (width < 1 || width > 100000 || height < 1 || height > 100000)
      file.fault(fmt::format("a picture has {} x {} px", width, height), kWholeModel, true);
    Camera camera = colmap_camera(kind.name, {p.begin(), p.end()}, {path.string()});
    camera.width = static_cast<int>(width), camera.height = static_cast<int>(height);
    model.cameras[id] = std::move(camera);
  }
  expect_end(file);
}

void read_images_bin(const fs::path& path, ColmapModel& model) {
  FileCursor file(path);
  for (auto n = file.number<uint64_t>(); n > 0; --n) {
    ColmapImage image;
    file.number<uint32_t>();
    image.q = reals(file, 4);
    image.t = reals(file, 3);
    image.camera = file.number<uint32_t>();
    image.name = text(file);
    if (!model.cameras.contains(image.camera))
      file.fault(fmt::format("cameras.bin has no camera {}", image.camera), "files of one model",
                 true);
    for (auto points = file.number<uint64_t>(); points > 0; --points) {
      const Eigen::Vector2d pixel = reals(file, 2);
      const auto point = file.number<uint64_t>();
      if (point != UINT64_MAX) image.seen.push_back({pixel, point});
    }
    model.images.push_back(std::move(image));
  }
  expect_end(file);
}

void read_points_bin(const fs::path& path, ColmapModel& model) {
  FileCursor file(path);
  for (auto n = file.number<uint64_t>(); n > 0; --n) {
    const auto id = file.number<uint64_t>();
    model.points[id] = reals(file, 3);
    file.skip(3);           // colour
    file.number<double>();  // error
    for (auto track = file.number<uint64_t>(); track > 0; --track) file.number<uint64_t>();
  }
  expect_end(file);
}

}  // namespace

ColmapModel read_colmap_binary(const fs::path& folder) {
  ColmapModel model;
  read_cameras_bin(folder / "cameras.bin", model);
  read_images_bin(folder / "images.bin", model);
  if (std::error_code error; fs::is_regular_file(folder / "points3D.bin", error))
    read_points_bin(folder / "points3D.bin", model);
  return model;
}

}  // namespace hookeye::detail
