#include "calibration/photos.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "capture_io/image.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

/// `*` stands for any characters, `?` for one.
bool matches(const std::string& pattern, const std::string& name) {
  size_t p = 0, n = 0, star = std::string::npos, from = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++, from = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p, ++n;
    } else if (star != std::string::npos) {
      p = star + 1, n = ++from;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

bool is_photo(const fs::path& file) {
  static const std::set<std::string> kinds{".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr",
                                           ".bmp", ".pgm", ".dng",  ".cr2", ".nef",  ".arw"};
  std::string kind = file.extension().string();
  std::ranges::transform(kind, kind.begin(), [](unsigned char c) { return std::tolower(c); });
  return kinds.contains(kind);
}

std::vector<fs::path> files_of(const std::string& source) {
  const fs::path path(source);
  std::error_code error;
  const bool folder = fs::is_directory(path, error);
  const std::string pattern = folder ? "*" : path.filename().string();
  if (!folder && pattern.find_first_of("*?") == std::string::npos) {
    if (!fs::exists(path, error))
      throw InputError({source}, "there is no such photo, folder or pattern",
                       "photos of the board, as 'calib/left_*.png'");
    return {path};
  }
  const fs::path where = folder ? path : path.has_parent_path() ? path.parent_path() : ".";
  std::vector<fs::path> files;
  for (fs::directory_iterator at(where, error), end; !error && at != end; at.increment(error))
    if (at->is_regular_file() && matches(pattern, at->path().filename().string()) &&
        (!folder || is_photo(at->path())))
      files.push_back(folder || path.has_parent_path() ? at->path() : at->path().filename());
  if (files.empty())
    throw InputError({source}, "no photo is found there",
                     "a folder that is there, or a quoted pattern as 'calib/left_*.png'");
  return files;
}

/// The last run of digits in the name, without zeros in front; "" where there is none.
std::string number_of(const fs::path& file) {
  const std::string stem = file.stem().string();
  const size_t last = stem.find_last_of("0123456789");
  if (last == std::string::npos) return {};
  const size_t before = stem.find_last_not_of("0123456789", last);
  const size_t first = before == std::string::npos ? 0 : before + 1;
  std::string digits = stem.substr(first, last + 1 - first);
  digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size() - 1));
  return digits;
}

using Files = std::vector<fs::path>;

/// By number where there is one in each name (9 before 10), else by name.
void sort_photos(Files& files) {
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) {
    const std::string m = number_of(a), n = number_of(b);
    if (m.size() != n.size()) return m.size() < n.size();
    return m != n ? m < n : a < b;
  });
  files.erase(std::unique(files.begin(), files.end()), files.end());
}

/// Photo -> instant by numbers; nothing where a number stands twice, or no two cameras share one.
std::optional<std::map<std::string, size_t>> numbered(const std::vector<Files>& cameras) {
  std::map<std::string, int> seen;
  for (const Files& files : cameras) {
    std::set<std::string> own;
    for (const fs::path& file : files)
      if (number_of(file).empty() || !own.insert(number_of(file)).second) return {};
    for (const std::string& number : own) ++seen[number];
  }
  if (std::ranges::none_of(seen, [](const auto& s) { return s.second > 1; })) return {};
  std::vector<std::string> order;
  for (const auto& [number, count] : seen) order.push_back(number);
  std::ranges::stable_sort(order, {}, [](const std::string& n) { return n.size(); });
  std::map<std::string, size_t> instants;
  for (const std::string& number : order) instants.emplace(number, instants.size());
  return instants;
}

void pair_photos(const std::vector<CameraPhotos>& cameras, const std::vector<Files>& files,
                 PhotoList& list) {
  const auto numbers = cameras.size() > 1 ? numbered(files) : std::nullopt;
  if (numbers) {
    list.instants.resize(numbers->size());
    for (const auto& [number, instant] : *numbers) list.instants[instant] = number;
    list.said.push_back("photos of one instant are those of one number in their names");
  } else {
    for (const fs::path& file : files[0]) list.instants.push_back(file.filename().string());
    for (size_t c = 1; c < files.size(); ++c)
      if (files[c].size() != files[0].size())
        throw InputError(
            {cameras[c].sources.front()},
            fmt::format("`{}` has {} photos and `{}` has {}, and no numbers in their names tell "
                        "which belong together",
                        cameras[0].name, files[0].size(), cameras[c].name, files[c].size()),
            "the same number in the names of photos of one instant: left_07.png right_07.png");
    if (files.size() > 1)
      list.said.push_back(
          "photos of one instant are those at the same place in the order of names");
  }
  for (size_t c = 0; c < files.size(); ++c)
    for (size_t i = 0; i < files[c].size(); ++i)
      list.photos.push_back({files[c][i], c, numbers ? numbers->at(number_of(files[c][i])) : i});
}

void check_sizes(const std::vector<CameraPhotos>& cameras, PhotoList& list) {
  list.sizes.assign(cameras.size(), {0, 0});
  for (const BoardPhoto& photo : list.photos) {
    const ImageHeader header = read_image_header(photo.file);
    auto& size = list.sizes[photo.camera];
    if (size.first == 0) size = {header.width, header.height};
    if (size != std::pair{header.width, header.height})
      throw InputError(
          {photo.file.string()},
          fmt::format("this photo has {} x {} px, others of `{}` have {} x {}", header.width,
                      header.height, cameras[photo.camera].name, size.first, size.second),
          "photos of one camera at one setting, not cut, turned or scaled");
  }
}

}  // namespace

PhotoList list_photos(const std::vector<CameraPhotos>& cameras) {
  PhotoList list;
  std::vector<Files> files;
  std::map<fs::path, std::string> taken;
  for (const CameraPhotos& camera : cameras) {
    files.emplace_back();
    for (const std::string& source : camera.sources) {
      const Files more = files_of(source);
      files.back().insert(files.back().end(), more.begin(), more.end());
    }
    sort_photos(files.back());
    for (const fs::path& file : files.back())
      if (const auto [at, is_new] = taken.emplace(file, camera.name);
          !is_new && at->second != camera.name)
        throw InputError(
            {file.string()},
            fmt::format("this photo is one of `{}` and of `{}`", at->second, camera.name),
            "a pattern that takes the photos of one camera alone");
  }
  pair_photos(cameras, files, list);
  check_sizes(cameras, list);
  return list;
}

}  // namespace hookeye
