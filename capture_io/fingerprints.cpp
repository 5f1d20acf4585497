#include "capture_io/fingerprints.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <fstream>
#include <memory>
#include <vector>

#include "capture_io/run.h"
#include "capture_io/yaml_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

/// Tells marks of another kind apart: those of runs that an older program made.
const std::string kKind = "xxh3:";

std::string text_of(const XXH128_hash_t& hash) {
  return fmt::format("{}{:016x}{:016x}", kKind, hash.high64, hash.low64);
}

/// XXH3 of 128 bits over all bytes.
std::string fingerprint(const fs::path& file) {
  constexpr size_t kPiece = 1 << 20;
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> piece(kPiece);
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(),
                                                                       &XXH3_freeState);
  XXH3_128bits_reset(state.get());
  while (stream) {
    stream.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    XXH3_128bits_update(state.get(), piece.data(), static_cast<size_t>(stream.gcount()));
  }
  if (!stream.eof()) return kKind + "unreadable";
  return text_of(XXH3_128bits_digest(state.get()));
}

bool same_kind(const std::string& a, const std::string& b) {
  return a.starts_with(kKind) == b.starts_with(kKind);
}

void add_named(const YamlNode& node, const fs::path& folder,
               std::map<std::string, std::string>* out) {
  std::error_code ignored;
  if (node.kind == YamlNode::Kind::scalar && !node.text.empty() && node.text.size() < 1000 &&
      fs::is_regular_file(folder / node.text, ignored))
    out->try_emplace(node.text, fingerprint(folder / node.text));
  for (const YamlNode& item : node.items) add_named(item, folder, out);
  for (const YamlNode::Entry& entry : node.entries) add_named(entry.value, folder, out);
}

}  // namespace

std::string fingerprint_of(std::string_view bytes) {
  return text_of(XXH3_128bits(bytes.data(), bytes.size()));
}

std::map<std::string, std::string> fingerprints(const fs::path& yaml) {
  std::map<std::string, std::string> out;
  std::error_code ignored;
  if (!fs::is_regular_file(yaml, ignored)) return out;
  out[yaml.filename().string()] = fingerprint(yaml);
  try {
    const YamlNode root = parse_yaml(read_text(yaml), yaml.string());
    add_named(root, yaml.parent_path(), &out);
    const YamlNode* cameras = root.find("cameras");
    const YamlNode* part = cameras ? file_of_section(*cameras) : nullptr;
    if (part && out.count(part->text))
      add_named(load_section(yaml.parent_path() / part->text, part->text, "cameras"),
                yaml.parent_path(), &out);
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
    if (found->second != mark && same_kind(found->second, mark)) return name;
  }
  for (const auto& [name, mark] : now)
    if (!then.count(name)) return name;
  return "";
}

}  // namespace hookeye
