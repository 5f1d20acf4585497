// Cameras as capture.yaml has them.
#pragma once

#include <string>

#include "capture_io/camera.h"

namespace hookeye {

/// A name as yaml takes it: plain where it is one word of letters that no yaml reader takes for
/// something else, else as a JSON string.
std::string yaml_name(const std::string& text);
/// The camera's entry below `cameras:`, indented by two, numbers to the last bit.
std::string camera_text(const Camera& camera);

}  // namespace hookeye
