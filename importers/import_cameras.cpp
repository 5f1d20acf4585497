// What holds for all sources: sizes, names, lengths, and that a capture takes what comes out.
#include <fmt/format.h>

#include <cmath>
#include <set>

#include "capture_io/camera_text.h"
#include "capture_io/capture_reader.h"
#include "capture_io/yaml_file.h"
#include "importers/importer.h"

namespace hookeye {
namespace {

/// A name that can be a file's: letters, digits and -_. of it, told apart by a number.
std::string usable_name(const std::string& name, const std::set<std::string>& taken) {
  std::string out;
  for (const char c : name) {
    const bool plain =
        std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == '.';
    out += plain ? c : '_';
  }
  out = out.substr(0, 80);
  if (out.empty() || out[0] == '.') out = "camera" + out;
  if (!taken.contains(out)) return out;
  for (int i = 2;; ++i)
    if (std::string other = fmt::format("{}_{}", out, i); !taken.contains(other)) return other;
}

void set_size(Camera& camera, const ImportOptions& options, const Place& place) {
  if (camera.width == 0) {
    if (options.width == 0)
      throw InputError(place, fmt::format("the picture size of `{}` is not in it", camera.name),
                       "give the size of its photos: --size 1280x1024");
    camera.width = options.width, camera.height = options.height;
  } else if (options.width != 0 &&
             (camera.width != options.width || camera.height != options.height)) {
    throw InputError(
        place,
        fmt::format("`{}` was calibrated for {} x {} px, --size says {} x {}", camera.name,
                    camera.width, camera.height, options.width, options.height),
        "leave --size out; photos have the size that was calibrated");
  }
}

/// The cameras as a capture reads them: whatever it would refuse is refused here.
std::vector<Camera> read_back(const Imported& imported, const Place& place) {
  const YamlNode root = parse_yaml(cameras_yaml(imported, ""), place.file);
  try {
    return read_cameras(root.entries.at(0).value, {});
  } catch (const InputError& error) {
    throw InputError(place, error.wrong(), error.right());
  }
}

}  // namespace

Imported import_cameras(const Importer& importer, const Importer::Sources& sources,
                        const ImportOptions& options) {
  Imported imported = importer.read(sources, options);
  const Place place{sources.front().string()};
  if (imported.cameras.empty())
    throw InputError(place, "there is no camera in it", "a " + importer.title());
  std::set<std::string> names;
  for (Camera& camera : imported.cameras) {
    camera.name = usable_name(camera.name, names);
    names.insert(camera.name);
    camera.t *= options.scale;
    set_size(camera, options, place);
  }
  for (SeenPoint& point : imported.seen) point.x *= options.scale;
  imported.cameras = read_back(imported, place);
  return imported;
}

std::string cameras_yaml(const Imported& imported, const std::string& head) {
  std::string out = head + "cameras:\n";
  for (const Camera& camera : imported.cameras) out += camera_text(camera);
  return out;
}

std::vector<Reprojection> reproject(const Imported& imported) {
  std::vector<Reprojection> out(imported.cameras.size());
  for (const SeenPoint& point : imported.seen) {
    Reprojection& of = out.at(point.camera);
    of.rms_px += (imported.cameras[point.camera].project(point.x) - point.pixel).squaredNorm();
    ++of.points;
  }
  for (Reprojection& of : out)
    if (of.points > 0) of.rms_px = std::sqrt(of.rms_px / static_cast<double>(of.points));
  return out;
}

}  // namespace hookeye
