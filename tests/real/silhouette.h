// Silhouettes cut out of photos by colour or brightness, as a user would with any paint program.
#pragma once

#include <functional>

#include "capture_io/image.h"

namespace hookeye::real {

/// 1 on the connected patch (4 neighbours) around `seed` of the pixels for which `inside` holds,
/// 0 elsewhere. `inside` sees the stored values (0..1) of the photo's channels.
Image silhouette(const Image& stored, int seed_x, int seed_y,
                 const std::function<bool(const float* pixel)>& inside);

/// The photo's stored values, 0..1, without any gamma taken out.
Image stored_values(const std::filesystem::path& file);

}  // namespace hookeye::real
