// COLMAP's sparse model: a folder with cameras, images and points3D, as text or binary.
//
// x_in_camera = R(q) x + t; the centre of the first pixel is (0.5, 0.5).
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "importers/colmap_model.h"
#include "importers/detail.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

bool has(const fs::path& folder, const char* ending) {
  std::error_code error;
  return fs::is_regular_file(folder / (std::string("cameras") + ending), error) &&
         fs::is_regular_file(folder / (std::string("images") + ending), error);
}

/// The model's folder: the one that is named, or where COLMAP puts the first one below a project.
fs::path model_folder(const fs::path& named) {
  for (const fs::path& folder : {named, named / "sparse" / "0", named / "sparse", named / "0"})
    if (has(folder, ".bin") || has(folder, ".txt")) return folder;
  return {};
}

Camera camera_of(const detail::ColmapImage& image, const Camera& optics, const Place& place) {
  const Eigen::Quaterniond q(image.q[0], image.q[1], image.q[2], image.q[3]);
  if (!(std::abs(q.norm() - 1) < 1e-3))
    throw InputError(
        place, fmt::format("the quaternion of image {} has length {:g}", image.name, q.norm()),
        "a quaternion of length 1");
  Camera camera = optics;
  camera.R = q.normalized().toRotationMatrix();
  camera.t = image.t;
  return camera;
}

class Colmap final : public Importer {
 public:
  std::string name() const override { return "colmap"; }
  std::string title() const override { return "COLMAP's sparse model (folder, txt or bin)"; }
  bool recognises(const Sources& sources) const override {
    return !model_folder(sources.front()).empty();
  }

  Imported read(const Sources& sources, const ImportOptions&) const override {
    const fs::path& named = detail::only_one(sources);
    const fs::path folder = model_folder(named);
    if (folder.empty())
      throw InputError({named.string()}, "this is no folder with cameras and images of COLMAP",
                       "name the folder of the sparse model, as sparse/0");
    detail::ColmapModel model =
        has(folder, ".bin") ? detail::read_colmap_binary(folder) : detail::read_colmap_text(folder);
    return told(model, {folder.string()});
  }

 private:
  static Imported told(detail::ColmapModel& model, const Place& place) {
    std::sort(model.images.begin(), model.images.end(),
              [](const auto& a, const auto& b) { return a.name < b.name; });
    std::vector<std::string> paths;
    for (const auto& image : model.images) paths.push_back(image.name);
    const std::vector<std::string> names = detail::photo_names(paths);
    Imported out;
    for (size_t i = 0; i < model.images.size(); ++i) {
      const detail::ColmapImage& image = model.images[i];
      out.cameras.push_back(camera_of(image, model.cameras.at(image.camera), place));
      out.cameras.back().name = names[i];
      for (const auto& seen : image.seen)
        if (const auto point = model.points.find(seen.point); point != model.points.end())
          out.seen.push_back({i, point->second, seen.pixel - Eigen::Vector2d(0.5, 0.5)});
    }
    out.world = "COLMAP's own frame";
    out.said.push_back(
        "COLMAP knows neither lengths nor axes: --scale takes the length of the capture that its "
        "unit measures; body and cameras must be brought into one frame");
    return out;
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_IMPORTER(colmap, Colmap)
