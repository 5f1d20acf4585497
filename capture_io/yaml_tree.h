// A yaml file as a tree whose every value keeps its place. The only file that touches yaml-cpp is
// yaml_tree.cpp.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/input_error.h"

namespace hookeye {

struct YamlNode {
  enum class Kind { null, scalar, sequence, map };
  struct Entry;

  Kind kind = Kind::null;
  Place place;
  std::string text;             ///< Kind::scalar
  std::vector<YamlNode> items;  ///< Kind::sequence
  std::vector<Entry> entries;   ///< Kind::map, in file order, keys unique

  const Entry* entry(const std::string& key) const;    ///< null: not there, or no map
  const YamlNode* find(const std::string& key) const;  ///< its value
};

struct YamlNode::Entry {
  std::string key;
  Place place;  ///< of the key
  YamlNode value;
};

/// Bounds that no honest file reaches, so that a hostile one cannot fill memory or the stack.
struct YamlLimits {
  size_t bytes = size_t{16} << 20;
  size_t alias_nodes = 10000;  ///< nodes that come out of aliases, all together
  int depth = 32;
  std::string holds = "capture";                              ///< what one file holds
  std::string begins = "a capture begins with `hookeye: 1`";  ///< what is right for an empty one
};

/// Parses one yaml document; `file` is the name used in places. Throws InputError: broken syntax,
/// no document or several, a key given twice, a key that is not a plain word, a limit exceeded.
YamlNode parse_yaml(const std::string& text, const std::string& file,
                    const YamlLimits& limits = {});

}  // namespace hookeye
