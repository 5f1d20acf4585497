#include "capture_io/fingerprints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <vector>

#include "capture_io/run.h"
#include "capture_io/yaml_tree.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

/// FNV-1a, 64 bit.
class Hash {
 public:
  void add(const char* bytes, size_t count) {
    for (size_t i = 0; i < count; ++i)
      value_ = (value_ ^ static_cast<unsigned char>(bytes[i])) * 1099511628211u;
  }
  std::string text() const { return fmt::format("{:016x}", value_); }

 private:
  uint64_t value_ = 14695981039346656037u;
};

std::string fingerprint(const fs::path& file) {
  constexpr uintmax_t kPiece = 64 << 10, kPieces = 16;
  const uintmax_t size = fs::file_size(file);
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> piece(kPiece);
  Hash hash;
  const std::string told = std::to_string(size);
  hash.add(told.data(), told.size());
  for (uintmax_t i = 0; i < kPieces; ++i) {
    // Pieces that follow each other in a small file, and reach its last byte in a large one.
    const uintmax_t at =
        std::max(i * kPiece, size > kPieces * kPiece ? (size - kPiece) / (kPieces - 1) * i : 0);
    if (at >= size) break;
    stream.seekg(static_cast<std::streamoff>(i + 1 == kPieces ? std::max(at, size - kPiece) : at));
    stream.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    hash.add(piece.data(), static_cast<size_t>(stream.gcount()));
    stream.clear();
  }
  return hash.text();
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

std::map<std::string, std::string> fingerprints(const fs::path& yaml) {
  std::map<std::string, std::string> out;
  std::error_code ignored;
  if (!fs::is_regular_file(yaml, ignored)) return out;
  out[yaml.filename().string()] = fingerprint(yaml);
  try {
    add_named(parse_yaml(read_text(yaml), yaml.string()), yaml.parent_path(), &out);
  } catch (const InputError&) {
    // told where the capture is read
  }
  return out;
}

std::string changed_since(const std::map<std::string, std::string>& then,
                          const std::map<std::string, std::string>& now) {
  for (const auto& [name, mark] : then) {
    const auto found = now.find(name);
    if (found == now.end() || found->second != mark) return name;
  }
  for (const auto& [name, mark] : now)
    if (!then.count(name)) return name;
  return "";
}

}  // namespace hookeye
