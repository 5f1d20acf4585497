// base64 (RFC 4648).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace hookeye {

std::string base64(const void* bytes, size_t size);

/// The bytes of one text or of several in a row, each padded to four digits; blanks between digits
/// are passed over. None where a character is no digit or the last four are not whole.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace hookeye
