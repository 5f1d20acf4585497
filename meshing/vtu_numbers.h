// Numbers of a vtu file's arrays, from its bytes: what stands below the XML (vtu.cpp).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hookeye::detail {

/// How all arrays of a file are written.
struct VtuFormat {
  bool long_heads = false;  ///< lengths ahead of the data: 64 bits, else 32
  bool zlib = false;        ///< data in compressed blocks
};

/// Whole numbers or double precision, as the file has them.
struct VtuNumbers {
  bool whole = false;
  std::vector<int64_t> integers;  ///< where whole
  std::vector<double> reals;      ///< else
  size_t size() const { return whole ? integers.size() : reals.size(); }
};

/// Is `type` one of Int8 to UInt64, Float32, Float64?
bool is_vtu_type(std::string_view type);

/// The bytes of an array that begins at the front of `stored`: its heads say how long it is. Throws
/// std::runtime_error with what is wrong.
std::string vtu_bytes(std::string_view stored, const VtuFormat& format);
/// Little-endian `bytes` as numbers of a type. Throws as above.
VtuNumbers vtu_numbers(std::string_view bytes, std::string_view type);
/// The same of numbers in text.
VtuNumbers vtu_numbers_of_text(std::string_view text, std::string_view type);

}  // namespace hookeye::detail
