#include "runs/printable.h"

#include <fmt/format.h>

#include <algorithm>

namespace hookeye {
namespace {

/// A character of UTF-8: its code and how many bytes it takes; 0 bytes: there is none at `at`.
struct Character {
  unsigned code = 0;
  size_t bytes = 0;
};

Character character_at(const std::string& text, size_t at) {
  const auto byte = [&](size_t i) { return static_cast<unsigned char>(text[at + i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return {first, 1};
  const size_t bytes = first >= 0xf0 && first < 0xf5   ? 4
                       : first >= 0xe0 && first < 0xf0 ? 3
                       : first >= 0xc2 && first < 0xe0 ? 2
                                                       : 0;
  if (bytes == 0 || at + bytes > text.size()) return {};
  unsigned code = first & (0x7fU >> bytes);
  for (size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0U) != 0x80U) return {};
    code = code << 6U | (byte(i) & 0x3fU);
  }
  // Shorter spellings of the same, halves of a pair, beyond the last.
  if ((bytes == 3 && code < 0x800) || (bytes == 4 && (code < 0x10000 || code > 0x10ffff)) ||
      (code >= 0xd800 && code < 0xe000))
    return {};
  return {code, bytes};
}

bool obeyed(unsigned code) {
  if (code == '\n' || code == '\t') return false;
  if (code < 0x20 || (code >= 0x7f && code < 0xa0)) return true;
  // Lines and directions of writing: a name could stand elsewhere than it is, or read otherwise.
  return code == 0x061c || code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) ||
         (code >= 0x2066 && code <= 0x2069);
}

}  // namespace

std::string printable(const std::string& text) {
  std::string out;
  out.reserve(text.size());
  for (size_t at = 0; at < text.size();) {
    const Character one = character_at(text, at);
    if (one.bytes == 0)
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[at]));
    else if (obeyed(one.code))
      out += fmt::format("\\u{:04x}", one.code);
    else
      out.append(text, at, one.bytes);
    at += std::max<size_t>(1, one.bytes);
  }
  return out;
}

}  // namespace hookeye
