#include "capture_io/yaml_place.h"

#include "capture_io/yaml_file.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {
YamlPlaces::YamlPlaces(const std::filesystem::path& file, const std::string& told)
    : root_(parse_yaml(read_text(file), told)) {
  const CaptureFolder folder{std::filesystem::path(told).parent_path(),
                             std::filesystem::canonical(file).parent_path()};
  for (YamlNode::Entry& entry : root_.entries)
    if (entry.key == "cameras" || entry.key == "examples")
      entry.value = section_in_place(entry.value, entry.key, folder);
}

Place YamlPlaces::of(std::initializer_list<std::string> path) const {
  const YamlNode* node = &root_;
  Place place = root_.place;
  for (const std::string& key : path) {
    const YamlNode::Entry* entry = node->entry(key);
    if (entry == nullptr) break;
    place = entry->place;
    node = &entry->value;
  }
  return place;
}

bool YamlPlaces::has(std::initializer_list<std::string> path) const {
  const YamlNode* node = &root_;
  for (const std::string& key : path) {
    const YamlNode::Entry* entry = node->entry(key);
    if (entry == nullptr) return false;
    node = &entry->value;
  }
  return true;
}

}  // namespace hookeye
