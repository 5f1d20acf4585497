#include "capture_io/yaml_place.h"

#include <algorithm>

#include "capture_io/run.h"

namespace hookeye {
namespace {

const YamlNode::Entry* entry_of(const YamlNode& node, const std::string& key) {
  const auto found = std::find_if(node.entries.begin(), node.entries.end(),
                                  [&](const YamlNode::Entry& entry) { return entry.key == key; });
  return found == node.entries.end() ? nullptr : &*found;
}

}  // namespace

YamlPlaces::YamlPlaces(const std::filesystem::path& file, const std::string& told)
    : root_(parse_yaml(read_text(file), told)) {}

Place YamlPlaces::of(std::initializer_list<std::string> path) const {
  const YamlNode* node = &root_;
  Place place = root_.place;
  for (const std::string& key : path) {
    const YamlNode::Entry* entry = entry_of(*node, key);
    if (entry == nullptr) break;
    place = entry->place;
    node = &entry->value;
  }
  return place;
}

bool YamlPlaces::has(std::initializer_list<std::string> path) const {
  const YamlNode* node = &root_;
  for (const std::string& key : path) {
    const YamlNode::Entry* entry = entry_of(*node, key);
    if (entry == nullptr) return false;
    node = &entry->value;
  }
  return true;
}

}  // namespace hookeye
