// Parts of a capture in words, as `check` prints them.
#pragma once

#include <string>

#include "capture_io/capture.h"

namespace hookeye {

/// "base: x +0 y +0 z +0", "grip: rigid +90 degrees about (0, 0, 1)".
std::string support_text(const SupportSpec& support);
/// "top: (0, 0, 0.3) N", "lid: pressure 0.02 MPa".
std::string load_text(const LoadSpec& load, const Units& units);
/// "force on grip", "strain from (0, 0, 5) to (0, 0, 25)".
std::string measured_text(const MeasuredSpec& measured);
std::string texture_text(const BodySpec& body);
std::string light_text(const Capture& capture);
std::string background_text(const BackgroundSpec& background);
/// As the file's values are read (read_photo).
std::string encoding_text(const PhotoSpec& spec);

}  // namespace hookeye
