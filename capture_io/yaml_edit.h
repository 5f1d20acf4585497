// One value of a yaml file set or removed while all else stays: comments, order, line ends.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture_io/yaml_tree.h"

namespace hookeye {

struct YamlEdit {
  /// Keys from the top. In a list the number of an item from 0 on, or "+": a new one behind the
  /// last. Maps and lists on the way that are not there are made.
  std::vector<std::string> path = {};
  /// On one line, as `{box: [[0, 0, 0], [1, 1, 1]]}`; none: the value goes with its key. A list
  /// that is left without items goes too; a map stays as `{}`.
  std::optional<std::string> value = {};
  bool first = false;      ///< a new key stands above the others of its map, else below them
  std::string above = {};  ///< of the top level: a new key stands above this one, where it is there
};

/// `text` with the edit in it. Read again it is the old tree with that one value changed, else
/// nothing is done: throws InputError with the place in `file` and what to write by hand, or for a
/// path to nothing.
std::string edited_yaml(const std::string& text, const std::string& file, const YamlEdit& edit);

/// Whether two trees tell the same, wherever they stand.
bool same_yaml(const YamlNode& a, const YamlNode& b);

/// Writes a capture whole, once read_capture() took it from a file beside; else throws what it
/// found and nothing changes. `dry`: only tried.
void store_capture(const std::filesystem::path& file, const std::string& text, bool dry = false);

}  // namespace hookeye
