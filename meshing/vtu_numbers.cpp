// The only file that touches zlib.
#include "meshing/vtu_numbers.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <stdexcept>

#include "meshing/file_cursor.h"

namespace hookeye::detail {
namespace {

[[noreturn]] void fault(const std::string& wrong) { throw std::runtime_error(wrong); }

/// Calls `use` with a number of the type that `type` names; false: there is none.
template <class Use>
bool with_type(std::string_view type, const Use& use) {
  if (type == "Float64") return use(double{}), true;
  if (type == "Float32") return use(float{}), true;
  if (type == "Int64") return use(int64_t{}), true;
  if (type == "UInt64") return use(uint64_t{}), true;
  if (type == "Int32") return use(int32_t{}), true;
  if (type == "UInt32") return use(uint32_t{}), true;
  if (type == "Int16") return use(int16_t{}), true;
  if (type == "UInt16") return use(uint16_t{}), true;
  if (type == "Int8") return use(int8_t{}), true;
  if (type == "UInt8") return use(uint8_t{}), true;
  return false;
}

/// Lengths from the front of an array.
class Heads {
 public:
  Heads(std::string_view stored, const VtuFormat& format) : stored_(stored), format_(format) {}
  uint64_t next() {
    uint64_t value = 0;
    const size_t size = format_.long_heads ? 8 : 4;
    std::memcpy(&value, take(size).data(), size);
    return value;
  }
  std::string_view take(uint64_t bytes) {
    if (bytes > stored_.size())
      fault(fmt::format("an array announces {} bytes more, {} are there", bytes, stored_.size()));
    const std::string_view out = stored_.substr(0, bytes);
    stored_.remove_prefix(bytes);
    return out;
  }

 private:
  std::string_view stored_;
  VtuFormat format_;
};

std::string inflated(std::string_view stored, uint64_t size) {
  constexpr uint64_t kMostRatio = 1100;  // zlib's own is 1032
  if (size > kMostRatio * (stored.size() + 1))
    fault(fmt::format("a block of {} bytes announces {} bytes", stored.size(), size));
  std::string out(size, '\0');
  uLongf length = size;
  const int status = uncompress(reinterpret_cast<Bytef*>(out.data()), &length,
                                reinterpret_cast<const Bytef*>(stored.data()), stored.size());
  if (status != Z_OK || length != size) fault("a compressed block is damaged");
  return out;
}

}  // namespace

bool is_vtu_type(std::string_view type) {
  return with_type(type, [](auto) {});
}

/// Compressed: number of blocks, bytes of each, bytes of the last (0: as the others), compressed
/// bytes of each; then the blocks.
std::string vtu_bytes(std::string_view stored, const VtuFormat& format) {
  Heads heads(stored, format);
  const uint64_t first = heads.next();
  if (!format.zlib) return std::string(heads.take(first));
  const uint64_t size = heads.next(), last = heads.next();
  std::vector<uint64_t> lengths;
  for (uint64_t block = 0; block < first; ++block) lengths.push_back(heads.next());
  std::string out;
  for (uint64_t block = 0; block < first; ++block)
    out += inflated(heads.take(lengths[block]), block + 1 == first && last > 0 ? last : size);
  return out;
}

VtuNumbers vtu_numbers(std::string_view bytes, std::string_view type) {
  VtuNumbers out;
  with_type(type, [&](auto number) {
    using Number = decltype(number);
    if (bytes.size() % sizeof number != 0)
      fault(fmt::format("{} bytes are no numbers of type {}", bytes.size(), type));
    out.whole = std::is_integral_v<Number>;
    const size_t count = bytes.size() / sizeof number;
    out.integers.reserve(out.whole ? count : 0);
    out.reals.reserve(out.whole ? 0 : count);
    for (size_t i = 0; i < count; ++i) {
      std::memcpy(&number, bytes.data() + i * sizeof number, sizeof number);
      if constexpr (std::is_integral_v<Number>) {
        out.integers.push_back(static_cast<int64_t>(number));
      } else {
        out.reals.push_back(number);
      }
    }
  });
  return out;
}

VtuNumbers vtu_numbers_of_text(std::string_view text, std::string_view type) {
  VtuNumbers out;
  out.whole = type.find("Int") != std::string_view::npos;
  constexpr std::string_view kBlanks = " \t\r\n";
  for (size_t at = 0; (at = text.find_first_not_of(kBlanks, at)) != std::string_view::npos;) {
    const size_t end = std::min(text.find_first_of(kBlanks, at), text.size());
    const std::string_view field = text.substr(at, end - at);
    int64_t whole = 0;
    double real = 0.0;
    const auto [stop, error] = std::from_chars(field.data(), field.data() + field.size(), whole);
    const bool is_whole = error == std::errc() && stop == field.data() + field.size();
    if (out.whole ? !is_whole : !is_real(field, real))
      fault(fmt::format("'{}' is no number of type {}", field, type));
    if (out.whole) {
      out.integers.push_back(whole);
    } else {
      out.reals.push_back(type == "Float32" ? static_cast<double>(static_cast<float>(real)) : real);
    }
    at = end;
  }
  return out;
}

}  // namespace hookeye::detail
