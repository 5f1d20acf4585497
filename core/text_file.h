// Text files, written whole or not at all.
#pragma once

#include <filesystem>
#include <string>

namespace hookeye {

/// By a temporary name and a rename, synced; into a pipe or a device as it is. Throws InputError.
void write_text(const std::filesystem::path& file, const std::string& text);

/// The bytes of a regular file. Throws InputError where there is none or it cannot be opened.
std::string read_text(const std::filesystem::path& file);

}  // namespace hookeye
