#include "core/fingerprint.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <fstream>
#include <memory>
#include <vector>

namespace hookeye {
namespace {

/// Tells marks of another kind apart: those of runs that an older program made.
const std::string kKind = "xxh3:";

std::string text_of(const XXH128_hash_t& hash) {
  return fmt::format("{}{:016x}{:016x}", kKind, hash.high64, hash.low64);
}

}  // namespace

std::string fingerprint_of(std::string_view bytes) {
  return text_of(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string fingerprint_of_file(const std::filesystem::path& file) {
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

bool same_kind_of_fingerprint(const std::string& a, const std::string& b) {
  return a.starts_with(kKind) == b.starts_with(kKind);
}

}  // namespace hookeye
