// The numbering scheme of photos: CAM_NNNN, NNNN_CAM, a folder a camera, a time of the day within.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "core/input_error.h"
#include "proposal/inventory.h"
#include "proposal/words.h"

namespace hookeye {

namespace fs = std::filesystem;

namespace {

/// A name cut at its numbers: text[0] digits[0] text[1] ... text[n].
struct CutName {
  fs::path file;
  std::vector<std::string> text, digits;
  std::string form() const {
    std::string out = file.parent_path().string() + "\n" + lower(file.extension().string());
    for (const std::string& piece : text) out += "\n" + piece;
    return out;
  }
};

CutName cut(const fs::path& file) {
  CutName name{file, {""}, {}};
  const std::string stem = file.stem().string();
  for (size_t i = 0; i < stem.size(); ++i) {
    const bool digit = std::isdigit(static_cast<unsigned char>(stem[i]));
    if (!digit) {
      name.text.back() += stem[i];
    } else {
      if (name.digits.size() < name.text.size()) name.digits.emplace_back();
      name.digits.back() += stem[i];
      if (i + 1 == stem.size() || !std::isdigit(static_cast<unsigned char>(stem[i + 1])))
        name.text.emplace_back();
    }
  }
  return name;
}

/// Without separators at its ends, and one where several follow each other.
std::string tidy(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool separator = c == '_' || c == '-' || c == '.' || c == ' ';
    if (separator && (out.empty() || out.back() == '_')) continue;
    out += separator ? '_' : c;
  }
  while (!out.empty() && out.back() == '_') out.pop_back();
  return out;
}

/// Which of the numbers in names of one form runs: the one with the most values; of such the last.
size_t running_number(const std::vector<CutName>& names) {
  size_t best = 0, most = 0;
  for (size_t k = 0; k < names.front().digits.size(); ++k) {
    std::set<std::string> values;
    for (const CutName& name : names) values.insert(name.digits[k]);
    if (values.size() >= most) most = values.size(), best = k;
  }
  return best;
}

/// Whether number k tells cameras apart: one running number stands with several of it.
bool tells_cameras(const std::vector<CutName>& names, size_t running, size_t k) {
  std::map<std::string, std::string> with;
  for (const CutName& name : names) {
    const auto [at, is_new] = with.emplace(name.digits[running], name.digits[k]);
    if (!is_new && at->second != name.digits[k]) return true;
  }
  return false;
}

/// One camera's photos before they have a name that is theirs alone.
struct Numbered {
  std::string text, folder;
  PhotoSeries series;
};

void add_form(const std::vector<CutName>& names, std::vector<Numbered>& out) {
  const size_t running = running_number(names);
  std::vector<size_t> keys;
  for (size_t k = 0; k < names.front().digits.size(); ++k)
    if (k != running && tells_cameras(names, running, k)) keys.push_back(k);
  std::map<std::string, Numbered> cameras;
  for (const CutName& name : names) {
    std::string text, scheme;
    for (size_t k = 0; k < name.text.size(); ++k) {
      text += name.text[k];
      scheme += name.text[k];
      if (k == name.digits.size()) continue;
      const bool key = std::find(keys.begin(), keys.end(), k) != keys.end();
      text += key ? name.digits[k] : "_";
      scheme += key ? name.digits[k] : std::string(name.digits[k].size(), '#');
    }
    Numbered& one = cameras[text];
    one.text = tidy(text);
    one.folder = name.file.parent_path().filename().string();
    one.series.scheme = scheme + name.file.extension().string();
    const std::string& digits = name.digits[running];
    const long number = std::stol(digits.substr(digits.size() > 15 ? digits.size() - 15 : 0));
    const auto [at, is_new] = one.series.photos.emplace(number, name.file);
    if (!is_new)
      throw InputError({name.file.string()},
                       fmt::format("photo {} of this camera is there twice: also {}", number,
                                   at->second.filename().string()),
                       "one photo a number and camera: move one of them away");
  }
  for (auto& [text, one] : cameras) out.push_back(std::move(one));
}

/// By the text of the names where it tells them apart, else by the folders, else by both.
void name_cameras(std::vector<Numbered>& found) {
  std::set<std::string> texts, folders;
  for (const Numbered& one : found) texts.insert(one.text), folders.insert(one.folder);
  for (Numbered& one : found) {
    std::string& name = one.series.camera;
    if (texts.size() == found.size() && !texts.contains(""))
      name = one.text;
    else if (folders.size() == found.size())
      name = one.folder;
    else
      name = tidy(one.folder + "_" + one.text);
    if (name.empty()) name = "camera";
  }
}

}  // namespace

std::vector<PhotoSeries> photo_series(const std::vector<fs::path>& pictures,
                                      std::vector<fs::path>& left) {
  std::map<std::string, std::vector<CutName>> forms;
  for (const fs::path& file : pictures) {
    CutName name = cut(file);
    if (name.digits.empty())
      left.push_back(file);
    else
      forms[name.form()].push_back(std::move(name));
  }
  std::vector<Numbered> found;
  for (const auto& [form, names] : forms) add_form(names, found);
  size_t most = 0;
  for (const Numbered& one : found) most = std::max(most, one.series.photos.size());
  // An overview, pictures of the set-up: a single one, or few, beside a series.
  std::vector<Numbered> kept;
  for (Numbered& one : found) {
    const size_t count = one.series.photos.size();
    if (most >= 3 && (count == 1 || 4 * count < most))
      for (const auto& [number, file] : one.series.photos) left.push_back(file);
    else
      kept.push_back(std::move(one));
  }
  name_cameras(kept);
  std::vector<PhotoSeries> out;
  for (Numbered& one : kept) out.push_back(std::move(one.series));
  std::sort(out.begin(), out.end(),
            [](const PhotoSeries& a, const PhotoSeries& b) { return a.camera < b.camera; });
  for (size_t i = 1; i < out.size(); ++i)
    if (out[i].camera == out[i - 1].camera)
      throw InputError({out[i].photos.begin()->second.string()},
                       fmt::format("two series of photos come out as camera `{}`: {} and {}",
                                   out[i].camera, out[i - 1].scheme, out[i].scheme),
                       "name them CAMERA_0001.tif, or put each camera into a folder of its own");
  return out;
}

}  // namespace hookeye
