#include "capture_io/fingerprints.h"

#include <fmt/format.h>

#include <vector>

#include "capture_io/yaml_file.h"
#include "core/fingerprint.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

void add_named(const YamlNode& node, const fs::path& folder,
               std::map<std::string, std::string>* out) {
  std::error_code ignored;
  if (node.kind == YamlNode::Kind::scalar && !node.text.empty() && node.text.size() < 1000 &&
      fs::is_regular_file(folder / node.text, ignored))
    out->try_emplace(node.text, fingerprint_of_file(folder / node.text));
  for (const YamlNode& item : node.items) add_named(item, folder, out);
  for (const YamlNode::Entry& entry : node.entries) add_named(entry.value, folder, out);
}

}  // namespace

std::map<std::string, std::string> fingerprints(const fs::path& yaml) {
  std::map<std::string, std::string> out;
  std::error_code ignored;
  if (!fs::is_regular_file(yaml, ignored)) return out;
  out[yaml.filename().string()] = fingerprint_of_file(yaml);
  try {
    const YamlNode root = parse_yaml(read_text(yaml), yaml.string());
    add_named(root, yaml.parent_path(), &out);
    for (const char* key : {"cameras", "examples"}) {
      const YamlNode* section = root.find(key);
      const YamlNode* part = section ? file_of_section(*section) : nullptr;
      if (part && out.count(part->text))
        add_named(load_section(yaml.parent_path() / part->text, part->text, key),
                  yaml.parent_path(), &out);
    }
  } catch (const InputError&) {
    // told where the capture is read
  }
  return out;
}

std::string changed_since(const std::map<std::string, std::string>& then,
                          const std::map<std::string, std::string>& now) {
  for (const auto& [name, mark] : then) {
    const auto found = now.find(name);
    if (found == now.end()) return name;
    if (found->second != mark && same_kind_of_fingerprint(found->second, mark)) return name;
  }
  for (const auto& [name, mark] : now)
    if (!then.count(name)) return name;
  return "";
}

}  // namespace hookeye
