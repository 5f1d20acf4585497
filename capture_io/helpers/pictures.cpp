// The only file that touches OpenImageIO. A program of its own: the library brings 250 others, and
// reads what strangers hand over.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

#include "capture_io/image.h"
#include "capture_io/png_chunks.h"
#include "core/helper.h"
#include "core/helper_main.h"
#include "core/parcels.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
constexpr double max_pixels = 1e9;
constexpr double max_bytes = 2147483648.0;  ///< of the decoded picture, four bytes a value
/// A forged header of some hundred bytes would cost all that memory before the pixels turn out to
/// be missing, so that what it claims is held against the size of the file. Deflate makes at most
/// 1032 bytes out of one (258 out of two bits); of the other formats JPEG 2000 packs a picture of
/// one grey most densely, 40,000 to one; without compression a palette of single bits grows to 24.
constexpr double deflate_ratio = 1032, any_ratio = 1e5, palette_ratio = 24;

std::string one_line(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// The library's explanations name the path again and differ between versions, so that only the
/// fact is reported.
[[noreturn]] void unreadable(const fs::path& file, const std::string& why) {
  throw InputError({file.string()}, why, "hand over a complete PNG, TIFF, JPEG or EXR picture");
}

/// JPEG readers fill the missing rest of a truncated file with grey and only warn. A complete file
/// has its end marker (FF D9) after the last scan marker (FF DA); cameras may append data after it.
bool jpeg_is_complete(const fs::path& file) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  std::string bytes(error ? 0 : size, '\0');
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) return false;
  const size_t scan = bytes.rfind("\xFF\xDA");
  const size_t end = bytes.rfind("\xFF\xD9");
  return scan != std::string::npos && end != std::string::npos && end > scan;
}

std::string claim_of(const OIIO::ImageSpec& spec) {
  return fmt::format("the header claims {} x {} pixels with {} channels", spec.width, spec.height,
                     spec.nchannels);
}

/// Whether a file of this size can hold what its header claims.
void check_claim(const fs::path& file, const OIIO::ImageSpec& spec) {
  std::error_code error;
  const auto size = static_cast<double>(fs::file_size(file, error));
  double claimed = static_cast<double>(spec.image_bytes()), ratio = any_ratio;
  if (is_png(file))
    claimed = png_claimed_bytes(file), ratio = deflate_ratio;
  else if (spec.get_string_attribute("compression") == "none")
    ratio = palette_ratio;
  if (error || claimed > ratio * size)
    unreadable(file, fmt::format("{}, which {:.0f} bytes cannot hold", claim_of(spec), size));
}

void check_size(const fs::path& file, const OIIO::ImageSpec& spec) {
  const double pixels = double(spec.width) * spec.height;
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0 || spec.depth > 1)
    unreadable(file, claim_of(spec));
  if (pixels > max_pixels || pixels * spec.nchannels * 4.0 > max_bytes)
    throw InputError({file.string()}, claim_of(spec),
                     "at most 2 GiB of decoded pixels are read: use a smaller picture");
  check_claim(file, spec);
  if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
      spec.height != spec.full_height)
    throw InputError({file.string()}, "the stored window differs from the displayed one",
                     "write the picture uncropped, so that pixel (0, 0) is its first pixel");
  if (spec.get_int_attribute("Orientation", 1) != 1)
    throw InputError({file.string()},
                     fmt::format("the picture carries the orientation tag {}",
                                 spec.get_int_attribute("Orientation", 1)),
                     "turn the pixels themselves and drop the tag: cameras are calibrated on "
                     "stored pixels");
}

std::unique_ptr<OIIO::ImageInput> open_image(const fs::path& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored))
    throw InputError({file.string()}, "there is no such file", "check the name and its folder");
  if (!fs::is_regular_file(file, ignored))
    throw InputError({file.string()}, "this is not a file", "name a picture");
  if (fs::file_size(file, ignored) == 0) unreadable(file, "the file is empty: it has no bytes");
  if (is_png(file) && !png_begins_well(file))
    unreadable(file, "the file cannot be read as a picture");
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  config.attribute("raw:ColorSpace", "linear");
  std::unique_ptr<OIIO::ImageInput> input;
  try {
    input = OIIO::ImageInput::open(file.string(), &config);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    // Some readers throw on broken headers instead of returning nothing.
  }
  if (!input) {
    OIIO::geterror();  // the pending message would be printed at exit otherwise
    unreadable(file, "the file cannot be read as a picture");
  }
  check_size(file, input->spec());
  return input;
}

bool is_floating(const OIIO::ImageSpec& spec) { return spec.format.is_floating_point(); }

ImageHeader header_of(const OIIO::ImageSpec& spec) {
  ImageHeader header;
  header.width = spec.width;
  header.height = spec.height;
  const int colours = spec.nchannels - (spec.alpha_channel >= 0 ? 1 : 0);
  header.channels = colours >= 3 ? 3 : 1;
  header.bits = static_cast<int>(spec.format.size()) * 8;
  header.floating = is_floating(spec);
  return header;
}

/// Channels `spec.nchannels` of all pixels to the first one or three colours.
template <class Value>
std::vector<Value> keep_colours(std::vector<Value> all, const OIIO::ImageSpec& spec) {
  const auto channels = static_cast<size_t>(header_of(spec).channels);
  const auto stored = static_cast<size_t>(spec.nchannels);
  if (channels == stored) return all;
  const size_t pixels = all.size() / stored;
  std::vector<Value> kept(pixels * channels);
  size_t source[3], found = 0;
  for (size_t c = 0; c < stored && found < channels; ++c)
    if (static_cast<int>(c) != spec.alpha_channel) source[found++] = c;
  for (size_t p = 0; p < pixels; ++p)
    for (size_t c = 0; c < found; ++c) kept[p * channels + c] = all[p * stored + source[c]];
  return kept;
}

/// The whole picture in floats, in the library, in the answer and in between.
void allow_pixels(const OIIO::ImageSpec& spec) {
  const double values = double(spec.width) * spec.height * spec.nchannels;
  const HelperLimits least;
  allow(least.memory + 6.0 * sizeof(float) * values, least.seconds + 1e-6 * values);
}

/// All values as `type`; what the library complains of is in input.geterror().
template <class Value>
std::vector<Value> read_values(OIIO::ImageInput& input, OIIO::TypeDesc type, bool* complete) {
  const OIIO::ImageSpec spec = input.spec();
  std::vector<Value> all(static_cast<size_t>(spec.width) * spec.height * spec.nchannels);
  try {
    *complete = input.read_image(0, 0, 0, spec.nchannels, type, all.data());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    *complete = false;
  }
  return keep_colours(std::move(all), spec);
}

/// What each code of one or two bytes stands for, by the library that would read floats.
std::vector<float> meaning_of_codes(OIIO::TypeDesc type) {
  std::vector<uint16_t> codes(type.size() == 1 ? 256 : 65536);
  std::iota(codes.begin(), codes.end(), uint16_t{0});
  const std::vector<uint8_t> bytes(codes.begin(), codes.end());
  std::vector<float> meaning(codes.size());
  const void* from = type.size() == 1 ? static_cast<const void*>(bytes.data()) : codes.data();
  OIIO::convert_pixel_values(type, from, OIIO::TypeDesc::FLOAT, meaning.data(),
                             static_cast<int>(codes.size()));
  return meaning;
}

ReadPicture read_stored(const fs::path& file) {
  const std::unique_ptr<OIIO::ImageInput> input = open_image(file);
  const OIIO::ImageSpec spec = input->spec();
  const std::string format = input->format_name();
  if ((format == "jpeg" && !jpeg_is_complete(file)) || (format == "png" && !png_is_intact(file)))
    unreadable(file, "the picture is truncated or damaged");
  allow_pixels(spec);
  ReadPicture out;
  const ImageHeader header = header_of(spec);
  out.width = header.width, out.height = header.height, out.channels = header.channels;
  out.srgb = !is_floating(spec) && spec.format.size() == 1;
  bool complete = false;
  const bool codes = spec.channelformats.empty();
  if (codes && spec.format == OIIO::TypeDesc::UINT8)
    out.bytes = read_values<uint8_t>(*input, spec.format, &complete);
  else if (codes && spec.format == OIIO::TypeDesc::UINT16)
    out.words = read_values<uint16_t>(*input, spec.format, &complete);
  else
    out.floats = read_values<float>(*input, OIIO::TypeDesc::FLOAT, &complete);
  if (out.floats.empty()) out.meaning = meaning_of_codes(spec.format);
  const std::string why = one_line(input->geterror());
  input->close();
  if (!complete || !why.empty()) unreadable(file, "the picture is truncated or damaged");
  return out;
}

ImageHeader read_header(const fs::path& file) {
  const std::unique_ptr<OIIO::ImageInput> input = open_image(file);
  ImageHeader header = header_of(input->spec());
  header.lossy = std::string(input->format_name()) == "jpeg";
  return header;
}

/// The camera's clock at the exposure; "" where the file does not say. A TIFF's DateTime is no such
/// thing: whatever converts a photo sets it.
std::string time_of(const fs::path& file) {
  const std::unique_ptr<OIIO::ImageInput> input = open_image(file);
  const OIIO::ImageSpec& spec = input->spec();
  for (const auto& [date, part] :
       {std::pair{"Exif:DateTimeOriginal", "Exif:SubsecTimeOriginal"},
        std::pair{"Exif:DateTimeDigitized", "Exif:SubsecTimeDigitized"}}) {
    const std::string told = spec.get_string_attribute(date);
    if (told.empty()) continue;
    const std::string fraction = spec.get_string_attribute(part);
    return fraction.empty() ? told : told + "." + fraction;
  }
  return "";
}

constexpr int kExifSrgb = 1;

/// "srgb" where EXIF says so.
std::string colours_of(const fs::path& file) {
  const std::unique_ptr<OIIO::ImageInput> input = open_image(file);
  return input->spec().get_int_attribute("Exif:ColorSpace") == kExifSrgb ? "srgb" : "";
}

OIIO::TypeDesc type_of(StoredAs stored) {
  if (stored == StoredAs::floats) return OIIO::TypeDesc::FLOAT;
  return stored == StoredAs::bytes ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16;
}

/// Where `memory` is told, there instead of in the file.
bool write(OIIO::ImageOutput& output, const std::string& file, const StoredImage& image,
           OIIO::Filesystem::IOVecOutput* memory) {
  const OIIO::TypeDesc type = type_of(image.stored);
  OIIO::ImageSpec spec(image.width, image.height, image.channels, type);
  if (image.stored == StoredAs::floats) spec.attribute("compression", "zip");
  if (std::string(output.format_name()) == "png")
    spec.attribute("png:compressionLevel", image.compression);
  if (!image.taken.empty()) {
    spec.attribute("compression", "zip");
    spec.attribute("Exif:DateTimeOriginal", image.taken);
    spec.attribute("Exif:SubsecTimeOriginal", image.fraction);
    if (image.srgb) spec.attribute("Exif:ColorSpace", kExifSrgb);
  }
  if (memory != nullptr && !output.set_ioproxy(memory)) return false;
  return output.open(file, spec) && output.write_image(type, image.values.data()) && output.close();
}

/// Why not, or "", and what was made in memory.
std::string stored(const std::string& file, const StoredImage& image, bool in_memory) {
  OIIO::Filesystem::IOVecOutput memory;
  std::string why;
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(file);
  if (!output)
    why = OIIO::geterror();
  else if (!write(*output, file, image, in_memory ? &memory : nullptr))
    why = "it could not be written: " + output->geterror();
  return Packer().put(one_line(why)).put(memory.buffer()).take();
}

std::string answer(Unpacker& request) {
  const auto task = request.take<std::string>(), file = request.take<std::string>();
  if (task == "write" || task == "encode")
    return stored(file, unpack_stored(request), task == "encode");
  Packer out;
  if (task == "header") return out.put(read_header(file)).take();
  if (task == "srgb") return out.put(colours_of(file)).take();
  if (task == "time") return out.put(time_of(file)).take();
  pack(out, read_stored(file));
  return out.take();
}

}  // namespace
}  // namespace hookeye

int main() {
  // Each thread would take address space, which is bounded.
  OIIO::attribute("threads", 1);
  OIIO::attribute("exr_threads", 1);
  return hookeye::serve(hookeye::answer);
}
