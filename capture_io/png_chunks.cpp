#include "capture_io/png_chunks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace hookeye {
namespace {

namespace fs = std::filesystem;

/// Of CRC-32, reflected polynomial 0xEDB88320 (PNG specification, annex D). crc_tables[k] is that
/// of a byte with k more behind it, so that eight are taken at once (slicing by eight: Kounavis and
/// Berry, A systematic approach to building high performance software-based CRC generators, 2005).
constexpr std::array<std::array<uint32_t, 256>, 8> crc_tables = [] {
  std::array<std::array<uint32_t, 256>, 8> tables{};
  for (uint32_t n = 0; n < 256; ++n) {
    uint32_t c = n;
    for (int bit = 0; bit < 8; ++bit) c = c & 1 ? 0xEDB88320u ^ (c >> 1) : c >> 1;
    tables[0][n] = c;
  }
  for (size_t k = 1; k < 8; ++k)
    for (size_t n = 0; n < 256; ++n) {
      const uint32_t before = tables[k - 1][n];
      tables[k][n] = tables[0][before & 0xFF] ^ (before >> 8);
    }
  return tables;
}();

uint32_t crc_with(uint32_t crc, const unsigned char* bytes, size_t count) {
  const auto little_endian = [](const unsigned char* from) {
    return uint32_t{from[3]} << 24 | uint32_t{from[2]} << 16 | uint32_t{from[1]} << 8 | from[0];
  };
  for (; count >= 8; bytes += 8, count -= 8) {
    const uint32_t low = crc ^ little_endian(bytes), high = little_endian(bytes + 4);
    crc = 0;
    for (size_t k = 0; k < 4; ++k)
      crc ^= crc_tables[7 - k][low >> 8 * k & 0xFF] ^ crc_tables[3 - k][high >> 8 * k & 0xFF];
  }
  for (; count > 0; ++bytes, --count) crc = crc_tables[0][(crc ^ *bytes) & 0xFF] ^ (crc >> 8);
  return crc;
}

uint32_t big_endian(const unsigned char* bytes) {
  return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 | uint32_t{bytes[2]} << 8 | bytes[3];
}

bool read_at(std::ifstream& stream, uintmax_t at, unsigned char* to, size_t count) {
  stream.seekg(static_cast<std::streamoff>(at));
  return static_cast<bool>(
      stream.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(count)));
}

/// Whether the checksum behind `length` bytes of data holds; `at` is where the chunk's name stands.
bool checksum_holds(std::ifstream& stream, uintmax_t at, uintmax_t length) {
  std::vector<unsigned char> piece(size_t{1} << 16);
  uint32_t crc = 0xFFFFFFFFu;
  for (uintmax_t done = 0; done < length + 4;) {
    const size_t count = std::min<uintmax_t>(piece.size(), length + 4 - done);
    if (!read_at(stream, at + done, piece.data(), count)) return false;
    crc = crc_with(crc, piece.data(), count);
    done += count;
  }
  unsigned char told[4];
  return read_at(stream, at + length + 4, told, 4) && big_endian(told) == (crc ^ 0xFFFFFFFFu);
}

/// Follows the chunks to the end, or to the first with pixels.
bool chunks_hold(const fs::path& file, bool before_pixels) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code error;
  const uintmax_t size = fs::file_size(file, error);
  for (uintmax_t at = 8; !error && at + 12 <= size;) {
    unsigned char head[8];
    if (!read_at(stream, at, head, sizeof head)) return false;
    const uintmax_t length = big_endian(head);
    const std::string name(head + 4, head + 8);
    if (at == 8 && (name != "IHDR" || length != 13)) return false;
    if (before_pixels && name == "IDAT") return true;
    const bool needed = (name[0] & 0x20) == 0;  // of other chunks the first letter is small
    if (needed && (at + 12 + length > size || !checksum_holds(stream, at + 4, length)))
      return false;
    if (name == "IEND") return !before_pixels;
    at += 12 + length;
  }
  return false;
}

}  // namespace

bool is_png(const fs::path& file) {
  char signature[8] = {};
  std::ifstream(file, std::ios::binary).read(signature, sizeof signature);
  return std::equal(signature, signature + 8, "\x89PNG\r\n\x1a\n");
}

bool png_begins_well(const fs::path& file) { return chunks_hold(file, true); }

bool png_is_intact(const fs::path& file) { return chunks_hold(file, false); }

double png_claimed_bytes(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  unsigned char header[10];  // width, height, bits a sample, kind of colour
  if (!read_at(stream, 16, header, sizeof header)) return 0.0;
  const double samples = header[9] == 2 ? 3 : header[9] == 4 ? 2 : header[9] == 6 ? 4 : 1;
  return big_endian(header + 4) * (1.0 + std::ceil(big_endian(header) * samples * header[8] / 8.0));
}

}  // namespace hookeye
