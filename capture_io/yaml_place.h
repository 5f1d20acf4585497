// Where a key of a capture stands, for what is found out long after it was read.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include "capture_io/yaml_tree.h"

namespace hookeye {

/// The keys of a capture file with their places.
class YamlPlaces {
 public:
  /// Reads the file again, and the one that holds its cameras; `told` is the name to use in places.
  /// Throws InputError as parse_yaml().
  YamlPlaces(const std::filesystem::path& file, const std::string& told);
  /// Of the value at the end of the path; where a key of it is not there, of the deepest that is.
  /// A key's own place stands for a map that begins on the next line.
  Place of(std::initializer_list<std::string> path) const;
  /// Whether all keys of the path are there.
  bool has(std::initializer_list<std::string> path) const;

 private:
  YamlNode root_;
};

}  // namespace hookeye
