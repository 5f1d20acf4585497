// The model's body drawn over every photo. The only file of the inspection that draws (OpenCV).
#pragma once

#include <filesystem>
#include <vector>

#include "estimation/inspection/inspection.h"
#include "estimation/inspection/sight.h"

namespace hookeye::inspection {

/// Writes EXAMPLE_CAMERA.png of every photo and contact_sheet.png of all into `folder`, which is
/// made where it is not there; fills PhotoLook::picture. Returns the sheet.
std::filesystem::path draw_pictures(Sight& sight, const std::filesystem::path& folder,
                                    std::vector<PhotoLook>* photos);

}  // namespace hookeye::inspection
