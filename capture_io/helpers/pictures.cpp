// The only file that touches OpenImageIO. A program of its own: the library brings 250 others, and
// reads what strangers hand over.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

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
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
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
Image keep_colours(const std::vector<float>& all, const OIIO::ImageSpec& spec) {
  const ImageHeader header = header_of(spec);
  Image image{header.width, header.height, header.channels, {}};
  image.values.resize(image.pixels() * image.channels);
  int source[3], found = 0;
  for (int c = 0; c < spec.nchannels && found < image.channels; ++c)
    if (c != spec.alpha_channel) source[found++] = c;
  for (size_t p = 0; p < image.pixels(); ++p)
    for (int c = 0; c < found; ++c)
      image.values[p * image.channels + c] = all[p * spec.nchannels + source[c]];
  return image;
}

/// The whole picture in floats, in the library, in the answer and in between.
void allow_pixels(const OIIO::ImageSpec& spec) {
  const double values = double(spec.width) * spec.height * spec.nchannels;
  const HelperLimits least;
  allow(least.memory + 6.0 * sizeof(float) * values, least.seconds + 1e-6 * values);
}

Image read_stored(const fs::path& file, bool& srgb) {
  const std::unique_ptr<OIIO::ImageInput> input = open_image(file);
  const OIIO::ImageSpec spec = input->spec();
  const std::string format = input->format_name();
  if ((format == "jpeg" && !jpeg_is_complete(file)) || (format == "png" && !png_is_intact(file)))
    unreadable(file, "the picture is truncated or damaged");
  allow_pixels(spec);
  std::vector<float> all(static_cast<size_t>(spec.width) * spec.height * spec.nchannels);
  bool complete = false;
  try {
    complete = input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, all.data());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    complete = false;
  }
  const std::string why = one_line(input->geterror());
  input->close();
  if (!complete || !why.empty()) unreadable(file, "the picture is truncated or damaged");
  srgb = !is_floating(spec) && spec.format.size() == 1;
  return keep_colours(all, spec);
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
  if (task == "time") return out.put(time_of(file)).take();
  bool srgb = false;
  const Image image = read_stored(file, srgb);
  out.put(srgb).put(image.width).put(image.height).put(image.channels).put(image.values);
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
