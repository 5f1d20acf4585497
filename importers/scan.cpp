// Scans of OpenMVS, Meshroom, Metashape, RealityCapture: obj with mtl and a picture (map_Kd of the
// materials that are used), ply with `comment TextureFile`. Texture coordinates have v up in both.
#include "importers/scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "capture_io/camera_text.h"
#include "capture_io/image.h"
#include "core/text_file.h"
#include "importers/detail.h"
#include "meshing/surface_mesh.h"
#include "meshing/tet_mesh.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

/// A picture and where it is named.
struct ScanPicture {
  fs::path file;
  Place place;
};

/// The rest of a line behind its first word, without blanks around; separators as here.
std::string behind_word(const std::string& line, size_t word) {
  const size_t begin = line.find_first_not_of(" \t", word);
  if (begin == std::string::npos) return "";
  std::string out = line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin);
  std::replace(out.begin(), out.end(), '\\', '/');
  return out;
}

/// A picture in a material may follow options with numbers: "-s 1 1 1 skin.png".
std::string behind_options(const std::string& text) {
  if (!text.starts_with('-')) return text;
  const size_t blank = text.find_last_of(" \t");
  return blank == std::string::npos ? "" : text.substr(blank + 1);
}

struct ObjNames {
  std::vector<ScanPicture> libraries;
  std::set<std::string> used;  ///< materials
};

ObjNames names_in_obj(const fs::path& file) {
  ObjNames out;
  std::istringstream text(read_text(file));
  Place place{file.string(), 0};
  for (std::string line; std::getline(text, line);) {
    ++place.line;
    if (line.starts_with("mtllib "))
      out.libraries.push_back({file.parent_path() / behind_word(line, 7), place});
    if (line.starts_with("usemtl ")) out.used.insert(behind_word(line, 7));
  }
  return out;
}

void pictures_of_library(const ScanPicture& library, const std::set<std::string>& used,
                         std::vector<ScanPicture>& out) {
  std::error_code error;
  if (!fs::is_regular_file(library.file, error))
    throw InputError(library.place,
                     fmt::format("there is no file {}", library.file.filename().string()),
                     "the materials beside the obj; without a texture take the line out");
  std::istringstream text(read_text(library.file));
  Place place{library.file.string(), 0};
  std::string material;
  for (std::string line; std::getline(text, line);) {
    ++place.line;
    const size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
    line.erase(0, begin);
    if (line.starts_with("newmtl ")) material = behind_word(line, 7);
    if (!line.starts_with("map_Kd ") || !(used.empty() || used.contains(material))) continue;
    out.push_back({library.file.parent_path() / behind_options(behind_word(line, 7)), place});
  }
}

std::vector<ScanPicture> pictures_of_ply(const fs::path& file) {
  std::vector<ScanPicture> out;
  std::istringstream text(read_text(file));
  Place place{file.string(), 0};
  for (std::string line; std::getline(text, line) && !line.starts_with("end_header");) {
    ++place.line;
    const std::string mark = "comment TextureFile ";
    if (line.starts_with(mark))
      out.push_back({file.parent_path() / behind_word(line, mark.size()), place});
  }
  return out;
}

std::vector<ScanPicture> pictures_of(const fs::path& file) {
  if (detail::has_ending(file, {".ply"})) return pictures_of_ply(file);
  const ObjNames names = names_in_obj(file);
  std::vector<ScanPicture> out;
  for (const ScanPicture& library : names.libraries) pictures_of_library(library, names.used, out);
  return out;
}

/// The one picture of a scan; refuses several.
const ScanPicture* only_picture(const std::vector<ScanPicture>& all) {
  if (all.empty()) return nullptr;
  for (const ScanPicture& one : all)
    if (one.file.lexically_normal() != all.front().file.lexically_normal())
      throw InputError(
          one.place,
          fmt::format("the texture is in several pictures: {} and {}",
                      all.front().file.filename().string(), one.file.filename().string()),
          "a capture has one: export the scan with one texture page");
  return &all.front();
}

void add_texture(const ScanPicture& picture, const SurfaceMesh& surface, const Place& scan,
                 ImportedScan& out) {
  std::error_code error;
  if (!fs::is_regular_file(picture.file, error))
    throw InputError(picture.place,
                     fmt::format("there is no picture {}", picture.file.filename().string()),
                     "the picture where the scan names it");
  if (surface.uv.empty())
    throw InputError(scan, "there is a texture, and no texture coordinates",
                     "an export with texture coordinates on all triangles");
  try {
    read_image_header(picture.file);
  } catch (const InputError& fault) {
    throw told_at(picture.place, fault);
  }
  std::string ending = picture.file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  out.texture = "texture" + ending;
  out.files.emplace_back(out.texture, read_text(picture.file));
}

/// What keeps the surface from being a body, for the user to mend.
void say_faults(const SurfaceMesh& surface, const Place& place, ImportedScan& out) {
  try {
    for (const std::string& said : mend(surface, place).said) out.said.push_back(said);
  } catch (const InputError& fault) {
    out.said.push_back(
        fmt::format("the surface bounds no body yet: {}. `hookeye mesh body.obj --repair` mends it",
                    fault.wrong()));
  }
}

}  // namespace

bool is_scan(const fs::path& file) { return detail::has_ending(file, {".obj", ".ply"}); }

ImportedScan import_scan(const fs::path& file, double scale, const fs::path& scratch) {
  const Place place{file.string()};
  SurfaceMesh surface = read_surface(file);
  surface.X *= scale;
  ImportedScan out;
  const std::vector<ScanPicture> pictures = pictures_of(file);
  const ScanPicture* picture = only_picture(pictures);
  write_surface_obj(scratch / "body.obj", surface);
  out.files.emplace_back("body.obj", read_text(scratch / "body.obj"));
  if (picture)
    add_texture(*picture, surface, place, out);
  else
    out.said.push_back(
        "the scan names no texture: one albedo is fitted, or sample it from photos "
        "at rest by `texture: {from: rest}`");
  say_faults(surface, place, out);
  out.vertices = static_cast<size_t>(surface.X.cols());
  out.triangles = surface.triangles.size();
  out.low = surface.X.rowwise().minCoeff(), out.high = surface.X.rowwise().maxCoeff();
  out.files.emplace_back("body.yaml",
                         "body:\n  surface: body.obj\n  texture: " +
                             (picture ? fmt::format("{{image: {}}}\n", yaml_name(out.texture))
                                      : std::string("{uniform: fit}\n")));
  return out;
}

}  // namespace hookeye
