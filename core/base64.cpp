#include "core/base64.h"

#include <algorithm>
#include <array>

namespace hookeye {
namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr signed char kNone = -1, kPadding = -2, kBlank = -3;

constexpr std::array<signed char, 256> values() {
  std::array<signed char, 256> out{};
  out.fill(kNone);
  for (size_t i = 0; i < kDigits.size(); ++i)
    out[static_cast<unsigned char>(kDigits[i])] = static_cast<signed char>(i);
  for (const unsigned char blank : {' ', '\t', '\r', '\n'}) out[blank] = kBlank;
  out['='] = kPadding;
  return out;
}

}  // namespace

std::string base64(const void* bytes, size_t size) {
  const auto* in = static_cast<const unsigned char*>(bytes);
  std::string out;
  out.reserve((size + 2) / 3 * 4);
  for (size_t i = 0; i < size; i += 3) {
    const unsigned have = static_cast<unsigned>(std::min<size_t>(3, size - i));
    const unsigned word = static_cast<unsigned>(in[i]) << 16 |
                          (have > 1 ? static_cast<unsigned>(in[i + 1]) << 8 : 0u) |
                          (have > 2 ? in[i + 2] : 0u);
    out += kDigits[word >> 18];
    out += kDigits[word >> 12 & 63];
    out += have > 1 ? kDigits[word >> 6 & 63] : '=';
    out += have > 2 ? kDigits[word & 63] : '=';
  }
  return out;
}

std::optional<std::string> from_base64(std::string_view text) {
  static constexpr std::array<signed char, 256> kValues = values();
  std::string out;
  out.reserve(text.size() / 4 * 3);
  unsigned word = 0;
  int digits = 0, padding = 0;
  for (const char c : text) {
    const signed char value = kValues[static_cast<unsigned char>(c)];
    if (value == kBlank) continue;
    if (value == kNone || (value == kPadding ? digits + padding < 2 : padding > 0)) return {};
    word = word << 6 | (value == kPadding ? 0u : static_cast<unsigned>(value));
    (value == kPadding ? padding : digits) += 1;
    if (digits + padding < 4) continue;
    out += static_cast<char>(word >> 16);
    if (padding < 2) out += static_cast<char>(word >> 8 & 255);
    if (padding < 1) out += static_cast<char>(word & 255);
    word = 0;
    digits = padding = 0;
  }
  if (digits + padding > 0) return {};
  return out;
}

}  // namespace hookeye
