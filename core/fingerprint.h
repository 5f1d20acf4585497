// Marks of bytes and files: equal marks, equal bytes.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hookeye {

/// XXH3 of 128 bits over all bytes, as "xxh3:" and 32 hexadecimal digits.
std::string fingerprint_of(std::string_view bytes);

/// Of a file, read piece by piece; "xxh3:unreadable" where it cannot be read.
std::string fingerprint_of_file(const std::filesystem::path& file);

/// Whether both are of the same kind, so that they can be compared: older programs made others.
bool same_kind_of_fingerprint(const std::string& a, const std::string& b);

}  // namespace hookeye
