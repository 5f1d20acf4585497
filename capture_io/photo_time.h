// When a photo was taken, by the clock of its camera.
#pragma once

#include <filesystem>
#include <optional>

namespace hookeye {

/// EXIF's DateTimeOriginal with its fraction (else DateTimeDigitized), in seconds since 1970
/// of whatever zone the camera's clock is in. Empty: the file does not say.
/// `whole_seconds`: it tells no fraction. Throws InputError where the picture cannot be read.
struct PhotoTime {
  double seconds = 0;
  bool whole_seconds = true;
};
std::optional<PhotoTime> read_photo_time(const std::filesystem::path& file);

}  // namespace hookeye
