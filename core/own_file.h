// Which file this program was loaded from.
#pragma once

#include <filesystem>

namespace hookeye {

/// The program, or the shared library (Python's module) that holds this code. Throws
/// std::runtime_error where the system does not tell.
std::filesystem::path own_file();

}  // namespace hookeye
