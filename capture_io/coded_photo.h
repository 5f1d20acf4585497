// Photos by the codes that a camera stored, with its clock.
#pragma once

#include <filesystem>
#include <string>

namespace hookeye {

struct CodedPhoto {
  int width = 0, height = 0, channels = 1;  ///< channels: 1 or 3
  int bits = 8;                             ///< of a code: 8 or 16
  std::string codes;   ///< row-major, channels interleaved; 16 bits in the machine's order
  bool srgb = false;   ///< what EXIF is to say of them; else nothing
  double seconds = 0;  ///< 0 .. 86400, told as of the first day of 1970: a clock of its own
};

/// A TIFF without loss, with the time in EXIF (read_photo_time). Throws
/// InputError where it cannot be written.
void write_coded_photo(const std::filesystem::path& file, const CodedPhoto& photo);

/// Whether EXIF says that the codes are sRGB. Throws InputError where the picture cannot be read.
bool is_told_srgb(const std::filesystem::path& file);

}  // namespace hookeye
