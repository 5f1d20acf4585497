// Pictures as bytes, between the program and its helpers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/wire.h"

namespace hookeye {

/// A picture as it is to be stored.
enum class StoredAs { bytes, words, floats };

struct StoredImage {
  int width = 0, height = 0, channels = 0;
  StoredAs stored = StoredAs::bytes;
  int compression = 6;  ///< of PNG
  std::string values;   ///< row-major, channels interleaved, of the kind `stored`
  /// Of a photo: EXIF's date and the digits of its fraction; "": none.
  std::string taken = {}, fraction = {};
  bool srgb = false;  ///< EXIF says that the codes are sRGB
};

/// A picture as its file holds it: codes with what each stands for, or floats.
struct ReadPicture {
  int width = 0, height = 0, channels = 0;
  bool srgb = false;  ///< what codes are where nothing is told
  std::vector<uint8_t> bytes;
  std::vector<uint16_t> words;
  std::vector<float> meaning;  ///< of each code: 256 of bytes, 65536 of words; of floats none
  std::vector<float> floats;

  size_t values() const {
    return static_cast<size_t>(width) * static_cast<size_t>(height) * static_cast<size_t>(channels);
  }
};

inline void pack(Packer& to, const ReadPicture& picture) {
  to.put(picture.width).put(picture.height).put(picture.channels).put(picture.srgb);
  to.put(picture.bytes).put(picture.words).put(picture.meaning).put(picture.floats);
}

inline ReadPicture unpack_read(Unpacker& from) {
  ReadPicture picture;
  from.get(picture.width);
  from.get(picture.height);
  from.get(picture.channels);
  picture.srgb = from.take<uint8_t>() != 0;
  from.get(picture.bytes);
  from.get(picture.words);
  from.get(picture.meaning);
  from.get(picture.floats);
  const bool sized =
      picture.width > 0 && picture.height > 0 && (picture.channels == 1 || picture.channels == 3);
  const size_t codes = !picture.bytes.empty() ? 256 : !picture.words.empty() ? 65536 : 0;
  if (!sized || picture.meaning.size() != codes ||
      picture.bytes.size() + picture.words.size() + picture.floats.size() != picture.values() ||
      (!picture.bytes.empty() && picture.bytes.size() != picture.values()) ||
      (!picture.words.empty() && picture.words.size() != picture.values()))
    throw WireFault();
  return picture;
}

inline void pack(Packer& to, const StoredImage& image) {
  to.put(image.width).put(image.height).put(image.channels).put(image.stored);
  to.put(image.compression).put(image.values).put(image.taken).put(image.fraction).put(image.srgb);
}

inline StoredImage unpack_stored(Unpacker& from) {
  StoredImage image;
  from.get(image.width);
  from.get(image.height);
  from.get(image.channels);
  from.get(image.stored);
  from.get(image.compression);
  from.get(image.values);
  from.get(image.taken);
  from.get(image.fraction);
  image.srgb = from.take<uint8_t>() != 0;
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
