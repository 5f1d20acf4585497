#include "estimation/model/photo_again.h"

#include <fmt/format.h>

#include <cstring>

#include "core/memory_left.h"
#include "core/work_clock.h"

namespace hookeye {

namespace {

/// Byte for byte.
bool same(const Image& a, const Image& b) {
  return a.values.size() == b.values.size() &&
         std::memcmp(a.values.data(), b.values.data(), a.values.size() * sizeof(float)) == 0;
}

}  // namespace

Photo read_again(const Scene& scene, int example, int photo, Weighed weighed) {
  const Working part(WorkPart::reading);
  const auto e = static_cast<size_t>(example), k = static_cast<size_t>(photo);
  const PhotoSpec& spec = scene.capture.examples[e].photos[k];
  Camera camera = scene.capture.camera(spec.camera);
  PhotoReading reading;
  if (const auto found = scene.readings.find(spec.camera); found != scene.readings.end()) {
    reading = found->second;
    camera.width = reading.taken_width, camera.height = reading.taken_height;
  }
  const MemoryClaim claim(decoding_bytes(camera));
  Photo out = PhotoReader().read(spec, camera, weighed);
  reading.share = 1.0;  // all tiles
  const Photo again = as_read(out, reading, "");
  const Photo& seen = scene.photos[e][k];
  for (size_t plane = 0; plane < seen.planes.size(); ++plane)
    if (plane >= again.planes.size() || !same(*again.planes[plane], *seen.planes[plane]))
      throw InputError(
          spec.place,
          fmt::format("the photo {} has changed since it was read", spec.file.filename().string()),
          "leave photos alone while a command works on them, and run it again");
  return out;
}

}  // namespace hookeye
