// Pictures as bytes, between the program and its helpers.
#pragma once

#include <string>

#include "core/wire.h"

namespace hookeye {

/// A picture as it is to be stored.
enum class StoredAs { bytes, words, floats };

struct StoredImage {
  int width = 0, height = 0, channels = 0;
  StoredAs stored = StoredAs::bytes;
  int compression = 6;  ///< of PNG
  std::string values;   ///< row-major, channels interleaved, of the kind `stored`
};

inline void pack(Packer& to, const StoredImage& image) {
  to.put(image.width).put(image.height).put(image.channels).put(image.stored);
  to.put(image.compression).put(image.values);
}

inline StoredImage unpack_stored(Unpacker& from) {
  StoredImage image;
  from.get(image.width);
  from.get(image.height);
  from.get(image.channels);
  from.get(image.stored);
  from.get(image.compression);
  from.get(image.values);
  const size_t size = image.stored == StoredAs::floats  ? 4
                      : image.stored == StoredAs::words ? 2
                                                        : 1;
  if (image.width < 0 || image.height < 0 || image.channels < 0 ||
      image.values.size() != size * static_cast<size_t>(image.width) *
                                 static_cast<size_t>(image.height) *
                                 static_cast<size_t>(image.channels))
    throw WireFault();
  return image;
}

}  // namespace hookeye
