#include "importers/detail.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "capture_io/camera_pose.h"

namespace hookeye::detail {

namespace fs = std::filesystem;

std::string head_of(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return "";
  std::string head(16384, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(stream.gcount()));
  std::transform(head.begin(), head.end(), head.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return head;
}

bool has_ending(const fs::path& file, const std::vector<std::string>& endings) {
  std::string own = file.extension().string();
  std::transform(own.begin(), own.end(), own.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(endings.begin(), endings.end(), own) != endings.end();
}

const fs::path& only_one(const Importer::Sources& sources) {
  if (sources.size() != 1)
    throw InputError({sources[1].string()}, "there is a second source",
                     "this kind holds all cameras in one: import it alone");
  return sources.front();
}

Motion motion_of(const std::vector<std::vector<double>>& rows, const Place& place,
                 const std::string& what) {
  const bool whole = (rows.size() == 3 || rows.size() == 4) &&
                     std::all_of(rows.begin(), rows.end(),
                                 [](const std::vector<double>& row) { return row.size() == 4; });
  if (!whole) throw InputError(place, what + " is no map of space", "four rows of four numbers");
  Motion motion;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      motion.R(i, j) = rows[static_cast<size_t>(i)][static_cast<size_t>(j)];
    motion.t[i] = rows[static_cast<size_t>(i)][3];
  }
  const std::string fault = make_rotation(motion.R);
  if (!fault.empty()) throw InputError(place, fmt::format("{} {}", what, fault), rotation_rule);
  if (rows.size() == 4 && rows[3] != std::vector<double>{0, 0, 0, 1})
    throw InputError(place, what + " does not end with 0 0 0 1", "a rotation and a translation");
  return motion;
}

std::vector<std::string> photo_names(const std::vector<std::string>& paths) {
  std::vector<std::string> short_names, long_names;
  std::map<std::string, int> count;
  for (const std::string& path : paths) {
    const fs::path file(path);
    short_names.push_back(file.stem().string());
    const std::string folders = file.parent_path().relative_path().string();
    long_names.push_back(folders.empty() ? short_names.back() : folders + "_" + short_names.back());
    ++count[short_names.back()];
  }
  for (size_t i = 0; i < paths.size(); ++i)
    if (count[short_names[i]] > 1) short_names[i] = long_names[i];
  return short_names;
}

}  // namespace hookeye::detail
