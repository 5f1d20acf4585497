// Pictures that are not stored in a file of their own.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hookeye {

/// A PNG of 16 bits of grey, row-major: the bytes of its file.
std::string encode_png(int width, int height, const std::vector<uint16_t>& grey);

}  // namespace hookeye
