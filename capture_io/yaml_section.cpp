#include "capture_io/yaml_section.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace hookeye {
namespace {

namespace fs = std::filesystem;

std::string shortened(const std::string& text) {
  std::string one_line;
  for (const char c : text.substr(0, 60)) one_line += static_cast<unsigned char>(c) < 32 ? '?' : c;
  return text.size() > 60 ? one_line + "..." : one_line;
}

/// pull_1.png and pull_2.png are two of a series, no slip of the pen.
std::string without_digits(std::string name) {
  std::erase_if(name, [](unsigned char c) { return std::isdigit(c); });
  return name;
}

/// "; did you mean `rest.obj`?" where the folder holds a file of nearly that name.
std::string nearest_file(const fs::path& missing) {
  std::vector<std::string> names, siblings;  // which differ in their numbers
  const std::string wanted = missing.filename().string();
  std::error_code error;
  for (fs::directory_iterator it(missing.parent_path(), error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    const bool sibling = without_digits(name) == without_digits(wanted);
    (sibling ? siblings : names).push_back(name);
    if (names.size() + siblings.size() > 1000) break;
  }
  if (!siblings.empty()) {
    std::sort(siblings.begin(), siblings.end());
    const size_t told = std::min<size_t>(siblings.size(), 4);
    return fmt::format("; its folder has {}{}",
                       fmt::join(siblings.begin(), siblings.begin() + told, ", "),
                       told < siblings.size() ? ", ..." : "");
  }
  std::sort(names.begin(), names.end());
  const std::string near = nearest_name(wanted, names);
  return near.empty() ? "" : fmt::format("; did you mean `{}`?", near);
}

}  // namespace

std::string describe(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::null:
      return "empty";
    case YamlNode::Kind::sequence:
      return fmt::format("a list of {}", node.items.size());
    case YamlNode::Kind::map:
      return "a map";
    case YamlNode::Kind::scalar:
      break;
  }
  return fmt::format("`{}`", shortened(node.text));
}

std::string suggest(const std::string& word, const std::vector<std::string>& known) {
  const std::string near = nearest_name(word, known);
  if (!near.empty()) return fmt::format("did you mean `{}`?", near);
  if (known.empty()) return "none is defined in this capture";
  return fmt::format("known here: {}", fmt::join(known, ", "));
}

void unexpected(const YamlNode& node, const std::string& what, const std::string& right) {
  throw InputError(node.place, fmt::format("{} is {}", what, describe(node)), right);
}

YamlSection::YamlSection(const YamlNode& node, std::string what, std::vector<std::string> known)
    : node_(node), what_(std::move(what)), known_(std::move(known)) {
  if (node.kind != YamlNode::Kind::map)
    unexpected(node, what_, fmt::format("write a map with the keys {}", fmt::join(known_, ", ")));
  for (const YamlNode::Entry& entry : node.entries)
    if (std::find(known_.begin(), known_.end(), entry.key) == known_.end())
      throw InputError(entry.place, fmt::format("{} has no key `{}`", what_, shortened(entry.key)),
                       suggest(entry.key, known_));
}

const YamlNode::Entry* YamlSection::entry(const std::string& key) const {
  if (std::find(known_.begin(), known_.end(), key) == known_.end())
    throw std::logic_error(fmt::format("{}: key {} is read but not declared", what_, key));
  return node_.entry(key);
}

const YamlNode* YamlSection::find(const std::string& key) const {
  const YamlNode::Entry* found = entry(key);
  return found ? &found->value : nullptr;
}

const YamlNode& YamlSection::need(const std::string& key, const std::string& right) const {
  const YamlNode* value = find(key);
  if (!value) throw InputError(node_.place, fmt::format("{} lacks `{}`", what_, key), right);
  return *value;
}

std::string YamlSection::one_of(const std::vector<std::string>& keys) const {
  const std::string* chosen = nullptr;
  for (const std::string& key : keys) {
    if (!has(key)) continue;
    if (chosen)
      throw InputError(entry(key)->place,
                       fmt::format("{} has both `{}` and `{}`", what_, *chosen, key),
                       "keep one of the two");
    chosen = &key;
  }
  if (!chosen)
    throw InputError(node_.place, fmt::format("{} lacks one of {}", what_, fmt::join(keys, ", ")),
                     "give exactly one of them");
  return *chosen;
}

std::optional<double> number_of(const YamlNode& node) {
  const std::string& text = node.text;
  if (node.kind != YamlNode::Kind::scalar) return {};
  if (text == ".nan" || text == ".NaN" || text == ".NAN") return std::nan("");
  if (text == ".inf" || text == "+.inf" || text == "-.inf") return INFINITY;
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (begin != end && *begin == '+') ++begin;
  double value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (begin == end || stop != end) return {};
  if (error == std::errc::result_out_of_range) return INFINITY;
  if (error != std::errc()) return {};
  return value;
}

double read_number(const YamlNode& node, const std::string& what) {
  const std::optional<double> value = number_of(node);
  if (!value) unexpected(node, what, "a number is expected");
  if (!std::isfinite(*value)) unexpected(node, what, "a finite number is expected");
  return *value;
}

double read_positive(const YamlNode& node, const std::string& what) {
  const double value = read_number(node, what);
  if (!(value > 0)) unexpected(node, what, "a number above zero is expected");
  return value;
}

double read_not_negative(const YamlNode& node, const std::string& what) {
  const double value = read_number(node, what);
  if (!(value >= 0)) unexpected(node, what, "zero or a number above it is expected");
  return value;
}

int read_integer(const YamlNode& node, const std::string& what) {
  int value = 0;
  const char* end = node.text.data() + node.text.size();
  const auto [stop, error] = std::from_chars(node.text.data(), end, value);
  if (node.kind != YamlNode::Kind::scalar || stop != end || error != std::errc())
    unexpected(node, what, "a whole number is expected");
  return value;
}

std::string read_string(const YamlNode& node, const std::string& what) {
  if (node.kind != YamlNode::Kind::scalar || node.text.empty())
    unexpected(node, what, "a text is expected");
  return node.text;
}

std::string read_choice(const YamlNode& node, const std::string& what,
                        const std::vector<std::string>& choices) {
  if (node.kind == YamlNode::Kind::scalar &&
      std::find(choices.begin(), choices.end(), node.text) != choices.end())
    return node.text;
  const std::string near = nearest_name(node.text, choices);
  unexpected(node, what,
             fmt::format("{}one of {} is expected",
                         near.empty() ? "" : fmt::format("did you mean `{}`? ", near),
                         fmt::join(choices, ", ")));
}

std::vector<double> read_numbers(const YamlNode& node, const std::string& what) {
  std::vector<double> numbers;
  for (const YamlNode& item : read_list(node, what, "a list of numbers is expected"))
    numbers.push_back(read_number(item, "a number of " + what));
  return numbers;
}

Eigen::Vector3d read_vector3(const YamlNode& node, const std::string& what) {
  if (node.kind != YamlNode::Kind::sequence || node.items.size() != 3)
    unexpected(node, what,
               node.kind == YamlNode::Kind::sequence && node.items.size() == 6
                   ? "three numbers are expected, with decimal points: [0.5, 0.25, 2.4]"
                   : "three numbers are expected: [x, y, z]");
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i)
    v[i] = read_number(node.items[i], fmt::format("component {} of {}", "xyz"[i], what));
  return v;
}

Eigen::Vector3d read_direction(const YamlNode& node, const std::string& what) {
  const Eigen::Vector3d v = read_vector3(node, what);
  const double length = v.stableNorm();
  if (!(length > 0) || !std::isfinite(length))
    throw InputError(node.place, what + " has no direction",
                     "a vector of finite length above zero is expected");
  return v / length;
}

const std::vector<YamlNode>& read_list(const YamlNode& node, const std::string& what,
                                       const std::string& right) {
  if (node.kind != YamlNode::Kind::sequence) unexpected(node, what, right);
  return node.items;
}

const std::vector<YamlNode::Entry>& read_named(const YamlNode& node, const std::string& what) {
  if (node.kind != YamlNode::Kind::map)
    unexpected(node, what, "a map from name to value is expected");
  for (const YamlNode::Entry& entry : node.entries) {
    const std::string& name = entry.key;
    const bool bad = name.empty() || name.size() > 100 || name[0] == '.' ||
                     std::any_of(name.begin(), name.end(), [](unsigned char c) {
                       return c < 32 || c == 127 || c == '/' || c == '\\';
                     });
    if (bad)
      throw InputError(entry.place,
                       fmt::format("`{}` cannot be a name in {}", shortened(name), what),
                       "names become file names: up to 100 characters, no slash, no leading dot");
  }
  return node.entries;
}

fs::path read_file_path(const YamlNode& node, const std::string& what, const CaptureFolder& folder,
                        const std::vector<std::string>& extensions) {
  const std::string text = read_string(node, what);
  const fs::path relative(text);
  if (text.find('\0') != std::string::npos || text.size() > 1000)
    unexpected(node, what, "a path relative to the capture's folder is expected");
  if (relative.is_absolute()) unexpected(node, what, "paths are relative to the capture's folder");
  std::error_code error;
  const fs::path file = fs::weakly_canonical(folder.canonical / relative, error);
  const auto [inside, rest] =
      std::mismatch(folder.canonical.begin(), folder.canonical.end(), file.begin(), file.end());
  if (error || inside != folder.canonical.end())
    unexpected(node, what, "the path leads out of the capture's folder: put the file inside");
  if (!fs::exists(file, error))
    unexpected(node, what, "there is no such file" + nearest_file(file));
  if (!fs::is_regular_file(file, error)) unexpected(node, what, "this is not a file");
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (!extensions.empty() &&
      std::find(extensions.begin(), extensions.end(), extension) == extensions.end())
    unexpected(node, what,
               fmt::format("a file of type {} is expected", fmt::join(extensions, ", ")));
  return file;
}

}  // namespace hookeye
