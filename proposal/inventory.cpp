#include "proposal/inventory.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>

#include "core/input_error.h"
#include "proposal/machine_record.h"
#include "proposal/words.h"

namespace hookeye {

namespace fs = std::filesystem;

namespace {

constexpr size_t kMostFiles = 200000;
constexpr int kDeepest = 4;

bool ends_with(const fs::path& file, const std::vector<std::string>& endings) {
  const std::string own = lower(file.extension().string());
  return std::find(endings.begin(), endings.end(), own) != endings.end();
}

std::string beginning(const fs::path& file) {
  std::string head(512, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(stream.gcount()));
  return head;
}

/// A key that stands at the start of a line.
bool has_key(const std::string& head, const std::string& key) {
  return head.starts_with(key + ":") || head.find("\n" + key + ":") != std::string::npos;
}

/// Runs of this program, and pictures of boards, of masks and of results.
bool is_passed_by(const fs::path& folder) {
  std::error_code error;
  return folder.filename().string().starts_with('.') || fs::exists(folder / "run.json", error);
}
bool is_of_boards(const fs::path& folder) {
  const std::string name = lower(folder.filename().string());
  for (const char* start : {"calib", "board", "charuco", "chess", "mask", "result"})
    if (name.starts_with(start)) return true;
  return false;
}

struct Files {
  std::vector<fs::path> pictures, boards, others, folders;
};

void list(const fs::path& folder, int depth, bool boards, size_t& count, Files& out) {
  static const std::vector<std::string> photos = {".tif", ".tiff", ".png", ".jpg", ".jpeg",
                                                  ".exr", ".cr2",  ".nef", ".arw", ".dng"};
  std::vector<fs::directory_entry> entries;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    entries.push_back(*at);
  if (error)
    throw InputError({folder.string()}, "the folder cannot be read: " + error.message(),
                     "name a folder that is open to you");
  std::sort(entries.begin(), entries.end());
  if ((count += entries.size()) > kMostFiles)
    throw InputError({folder.string()}, fmt::format("there are more than {} files", kMostFiles),
                     "name the folder of one test");
  for (const auto& entry : entries) {
    const fs::path& path = entry.path();
    if (entry.is_symlink(error) || path.filename().string().starts_with('.')) continue;
    if (entry.is_directory(error)) {
      if (is_passed_by(path) || depth == kDeepest) continue;
      out.folders.push_back(path);
      list(path, depth + 1, boards || is_of_boards(path), count, out);
    } else if (entry.is_regular_file(error)) {
      const bool picture = ends_with(path, photos);
      (!picture ? out.others : boards ? out.boards : out.pictures).push_back(path);
    }
  }
}

/// Files that one importer takes alone, or (OpenCV, ROS) all of a folder together.
void add_calibration(const fs::path& source, Inventory& out) {
  for (const Importer* importer : importers()) {
    if (!importer->recognises({source})) continue;
    // A folder that holds another's model is recognised as well.
    for (const CalibrationFile& known : out.calibrations)
      if (known.importer == importer && source.parent_path() == known.sources.front()) return;
    const bool together = importer->name() == "opencv" || importer->name() == "ros";
    for (CalibrationFile& known : out.calibrations)
      if (together && known.importer == importer &&
          known.sources.front().parent_path() == source.parent_path()) {
        known.sources.push_back(source);
        return;
      }
    out.calibrations.push_back({importer, {source}});
    return;
  }
}

void add_file(const fs::path& file, Inventory& out) {
  if (ends_with(file, {".stl", ".obj", ".ply"})) {
    out.surfaces.push_back(file);
  } else if (ends_with(file, {".msh", ".vtu", ".inp", ".mesh"})) {
    out.volumes.push_back(file);
  } else if (ends_with(file, {".yml", ".yaml", ".xml", ".json", ".caldat", ".bin"})) {
    const std::string head = beginning(file);
    if (has_key(head, "hookeye") || has_key(head, "hookeye_recipe")) return;
    const bool ours = head.starts_with("# hookeye ");
    if (ours && has_key(head, "cameras"))
      out.calibrations.push_back({nullptr, {file}});
    else if (!ours)  // else how well those cameras are known
      add_calibration(file, out);
  } else if (ends_with(file, {".csv", ".txt", ".tsv", ".dat", ".asc", ".tra"})) {
    auto table = read_text_table(file);
    if (table && is_machine_table(*table)) {
      out.tables.push_back(std::move(*table));
    } else {
      add_calibration(file, out);
      if (table) out.other_tables.push_back(std::move(*table));
    }
  } else if (ends_with(file, {".mp4", ".mov", ".avi", ".mkv", ".m4v", ".mpg", ".mpeg", ".wmv",
                              ".webm", ".mts"})) {
    out.videos.push_back(file);
  }
}

void say_left(const std::vector<fs::path>& left, const std::string& why, Inventory& out) {
  if (left.empty()) return;
  const std::string first = left.front().lexically_relative(out.folder).string();
  out.said.push_back(left.size() == 1
                         ? fmt::format("{} is left out: {}", first, why)
                         : fmt::format("{} and {} are left out: {}", first,
                                       counted(left.size() - 1, "other picture"), why));
}

}  // namespace

std::string CalibrationFile::name(const fs::path& folder) const {
  std::vector<std::string> names;
  for (const fs::path& source : sources)
    names.push_back(source.lexically_relative(folder).string());
  return fmt::format("{}", fmt::join(names, ","));
}

Inventory look_at(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error))
    throw InputError({folder.string()}, "there is no such folder",
                     "name the folder with the photos, the calibration, the mesh and the table");
  Inventory out;
  out.folder = fs::canonical(folder, error);
  Files files;
  size_t count = 0;
  list(out.folder, 0, false, count, files);
  std::vector<fs::path> photos, left;
  for (const fs::path& file : files.pictures) {
    const std::string name = lower(file.stem().string());
    if (name.starts_with("albedo") || name.starts_with("texture"))
      out.textures.push_back(file);
    else
      photos.push_back(file);
  }
  out.series = photo_series(photos, left);
  say_left(left, "not part of a series of photos", out);
  say_left(files.boards, "the folder's name says that they are boards, masks or results", out);
  for (const fs::path& one : files.folders) add_calibration(one, out);
  for (const fs::path& file : files.others) add_file(file, out);
  // What `import` or `calibrate` wrote was asked for, the file that it may be from was not.
  std::stable_partition(out.calibrations.begin(), out.calibrations.end(),
                        [](const CalibrationFile& one) { return one.importer == nullptr; });
  return out;
}

}  // namespace hookeye
