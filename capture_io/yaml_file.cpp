#include "capture_io/yaml_file.h"

#include <fmt/format.h>

#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {
namespace fs = std::filesystem;

YamlNode load_yaml(const fs::path& file, const std::string& told, const YamlLimits& limits) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (!error && size > limits.bytes)
    throw InputError({told}, fmt::format("{} bytes of yaml are too many", size),
                     fmt::format("at most {} MiB are read", limits.bytes >> 20));
  return parse_yaml(read_text(file), told, limits);
}

const YamlNode* file_of_section(const YamlNode& section) {
  const YamlNode* file = section.find("from");
  return file && file->kind == YamlNode::Kind::scalar ? file : nullptr;
}

YamlNode load_section(const fs::path& file, const std::string& told, const std::string& key) {
  YamlLimits limits;
  limits.holds = "map of " + key;
  limits.begins = fmt::format("write `{}:`, and below it the map as a capture has it", key);
  YamlNode root = load_yaml(file, told, limits);
  const YamlSection top(root, "the file of " + key, {key});
  YamlNode section = top.need(key, limits.begins);
  if (const YamlNode* further = file_of_section(section))
    unexpected(*further, "a second file of " + key, "the map itself stands in this file");
  return section;
}

YamlNode section_in_place(const YamlNode& section, const std::string& key,
                          const CaptureFolder& folder) {
  const YamlNode* named = file_of_section(section);
  if (!named) return section;
  for (const YamlNode::Entry& entry : section.entries)
    if (entry.key != "from")
      throw InputError(entry.place, fmt::format("{} has both `from` and `{}`", key, entry.key),
                       "keep all of them in the file, or all of them here");
  const fs::path file = read_file_path(*named, "file of " + key, folder, {".yaml", ".yml"});
  return load_section(file, (folder.given / named->text).string(), key);
}

}  // namespace hookeye
