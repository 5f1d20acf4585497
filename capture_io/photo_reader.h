// Many photos of one capture, one after the other or several at once.
#pragma once

#include <memory>

#include "capture_io/capture.h"

namespace hookeye {

/// Whether the noise of each pixel is worked out, which takes as long as all the rest. Of what is
/// only looked at nobody asks for it: `sigma` is empty.
enum class Weighed { no, yes };

/// read_image_header(); what is wrong with the file is told where the capture names it.
ImageHeader header_of(const PhotoSpec& spec);

/// As read_photo(), any thread. What photos share is read once: masks, and photos of what is behind
/// the body, which are kept as long as the reader.
class PhotoReader {
 public:
  PhotoReader();
  ~PhotoReader();
  Photo read(const PhotoSpec& spec, const Camera& camera, Weighed weighed);

  struct Shared;

 private:
  std::unique_ptr<Shared> shared_;
};

}  // namespace hookeye
