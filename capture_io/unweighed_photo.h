// Photos that are looked at and not fitted.
#pragma once

#include "capture_io/capture.h"

namespace hookeye {

/// read_photo() without the noise of each pixel (`sigma` is empty), which takes as long as all the
/// rest. Throws InputError as that does.
Photo read_unweighed_photo(const PhotoSpec& spec, const Camera& camera);

}  // namespace hookeye
