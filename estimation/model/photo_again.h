// A photo that is read a second time.
#pragma once

#include "capture_io/photo_reader.h"
#include "estimation/model/model.h"

namespace hookeye {

/// Photo `photo` of an example as the camera took it. Throws InputError, at the photo's place,
/// where its file has gone, or holds another one than the scene has.
Photo read_again(const Scene& scene, int example, int photo, Weighed weighed);

}  // namespace hookeye
