#include "capture_io/image.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "capture_io/encode_png.h"
#include "core/helper.h"
#include "core/parcels.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

HelperRequest request(const std::string& task, const fs::path& file) {
  return {.name = "pictures",
          .content = Packer().put(task).put(file.string()).take(),
          .limits = limits_for(file),
          .place = {file.string()},
          .right = "hand over a complete PNG, TIFF, JPEG or EXR picture"};
}

/// Of writing: why not, or "", and the bytes of what is made in memory.
std::pair<std::string, std::string> store(const std::string& task, const fs::path& file,
                                          const StoredImage& image) {
  HelperRequest wanted = request(task, file);
  Packer what;
  what.put(task).put(file.string());
  pack(what, image);
  wanted.content = what.take();
  wanted.limits = unlimited;
  return ask_helper(wanted, [](Unpacker& from) {
    auto why = from.take<std::string>();
    return std::pair{std::move(why), from.take<std::string>()};
  });
}

double srgb_to_linear(double v) {
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}
double linear_to_srgb(double v) {
  return v <= 0.0031308 ? v * 12.92 : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
}

double decode(double stored, const Encoding& encoding) {
  if (encoding.kind == Encoding::Kind::srgb) return srgb_to_linear(stored);
  if (encoding.kind == Encoding::Kind::gamma)
    return std::pow(std::max(stored, 0.0), encoding.gamma);
  return stored;
}
double encode(double linear, const Encoding& encoding) {
  if (encoding.kind == Encoding::Kind::srgb) return linear_to_srgb(linear);
  if (encoding.kind == Encoding::Kind::gamma)
    return std::pow(std::max(linear, 0.0), 1.0 / encoding.gamma);
  return linear;
}

void check_finite(const fs::path& file, const Image& image) {
  for (size_t i = 0; i < image.values.size(); ++i) {
    if (std::isfinite(image.values[i])) continue;
    const size_t pixel = i / image.channels;
    throw InputError(
        {file.string()},
        fmt::format("pixel ({}, {}) holds {}", pixel % image.width, pixel / image.width,
                    std::isnan(image.values[i]) ? "not a number" : "infinity"),
        "every pixel must be a finite number");
  }
}

template <class Value>
std::string bytes_of(const std::vector<Value>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)};
}

template <class Level>
std::string to_levels(const Image& image, const Encoding& encoding) {
  const double full = std::numeric_limits<Level>::max();
  std::vector<Level> levels(image.values.size());
  for (size_t i = 0; i < levels.size(); ++i)
    levels[i] = static_cast<Level>(std::lround(
        std::clamp(encode(std::clamp<double>(image.values[i], 0, 1), encoding), 0.0, 1.0) * full));
  return bytes_of(levels);
}

void undo(const Encoding& encoding, std::vector<float>* values) {
  if (encoding.kind == Encoding::Kind::linear) return;
  for (float& value : *values) value = static_cast<float>(decode(value, encoding));
}

template <class Code>
std::vector<float> looked_up(const std::vector<Code>& codes, const std::vector<float>& meaning) {
  std::vector<float> values(codes.size());
  for (size_t i = 0; i < codes.size(); ++i) values[i] = meaning[codes[i]];
  return values;
}

enum class Holes { no, yes };

/// Empty `encoding`: what is usual for such a file. `holes`: of floats, pixels that are no numbers.
Image decoded(const fs::path& file, std::optional<Encoding> encoding, Holes holes) {
  ReadPicture read = ask_helper(request("read", file), unpack_read);
  if (!encoding) encoding = Encoding{read.srgb ? Encoding::Kind::srgb : Encoding::Kind::linear};
  Image image{read.width, read.height, read.channels, {}};
  if (read.meaning.empty()) {
    image.values = std::move(read.floats);
    if (holes == Holes::no) check_finite(file, image);
    undo(*encoding, &image.values);
    return image;
  }
  // Once a code, not once a pixel.
  undo(*encoding, &read.meaning);
  image.values = read.words.empty() ? looked_up(read.bytes, read.meaning)
                                    : looked_up(read.words, read.meaning);
  return image;
}

}  // namespace

ImageHeader read_image_header(const fs::path& file) {
  return ask_helper(request("header", file),
                    [](Unpacker& from) { return from.take<ImageHeader>(); });
}

Image read_image_with_holes(const fs::path& file) { return decoded(file, Encoding{}, Holes::yes); }

Image read_image(const fs::path& file, std::optional<Encoding> encoding) {
  return decoded(file, encoding, Holes::no);
}

Image read_image(const NamedFile& file, std::optional<Encoding> encoding) {
  try {
    return read_image(file.path, encoding);
  } catch (const InputError& error) {
    throw told_at(file.place, error);
  }
}

void write_image(const fs::path& file, const Image& image, Encoding encoding) {
  const std::string type = file.extension().string();
  if (type != ".exr" && type != ".png" && type != ".tif" && type != ".tiff")
    throw std::invalid_argument("write_image: no such format: " + type);
  // The library chooses the format by the extension, so the temporary name keeps it.
  const fs::path temporary =
      file.parent_path() / fmt::format(".{}-{}{}", file.stem().string(), ::getpid(), type);
  StoredImage stored{image.width, image.height, image.channels, StoredAs::words, 6, {}};
  if (type == ".exr") {
    stored.stored = StoredAs::floats;
    stored.values = bytes_of(image.values);
  } else if (type == ".png") {
    stored.stored = StoredAs::bytes;
    // A third of the default's time; a run's hundreds of small pictures grow by some percent.
    stored.compression = 3;
    stored.values = to_levels<uint8_t>(image, encoding);
  } else {
    stored.values = to_levels<uint16_t>(image, encoding);
  }
  const std::string why = store("write", temporary, stored).first;
  if (why.empty()) {
    fs::rename(temporary, file);
    return;
  }
  std::error_code ignored;
  fs::remove(temporary, ignored);
  throw cannot_write(file.string(), why);
}

std::string encode_png(int width, int height, const std::vector<uint16_t>& grey) {
  const auto [why, bytes] =
      store("encode", "memory.png", {width, height, 1, StoredAs::words, 6, bytes_of(grey)});
  if (!why.empty()) throw std::runtime_error("a picture could not be encoded: " + why);
  return bytes;
}

}  // namespace hookeye
