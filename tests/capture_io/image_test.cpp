#include "capture_io/image.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>
#include <vector>

#include "capture_io/capture_folder.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye::test {
namespace {

namespace fs = std::filesystem;

Image ramp(int channels) {
  Image image{61, 47, channels, {}};
  image.values.resize(image.pixels() * channels);
  for (size_t i = 0; i < image.values.size(); ++i)
    image.values[i] = static_cast<float>((i * 37) % 1000) / 999.0f;
  return image;
}

/// Writes stored values as they are, in any format: independent of write_image().
void store(const fs::path& file, const Image& image, OIIO::TypeDesc type, int quality = 0,
           int orientation = 1) {
  auto output = OIIO::ImageOutput::create(file.string());
  ASSERT_TRUE(output);
  OIIO::ImageSpec spec(image.width, image.height, image.channels, type);
  if (quality) spec.attribute("Compression", "jpeg:" + std::to_string(quality));
  if (orientation != 1) spec.attribute("Orientation", orientation);
  ASSERT_TRUE(output->open(file.string(), spec)) << output->geterror();
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, image.values.data()));
  output->close();
}

double largest_difference(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels) return 1e9;
  double largest = 0;
  for (size_t i = 0; i < a.values.size(); ++i)
    largest = std::max<double>(largest, std::abs(a.values[i] - b.values[i]));
  return largest;
}

void put(std::string& bytes, size_t at, uint32_t value, int count, bool big_endian) {
  for (int i = 0; i < count; ++i)
    bytes[at + i] = static_cast<char>(value >> 8 * (big_endian ? count - 1 - i : i));
}

uint32_t crc32_of(const std::string& bytes) {
  uint32_t crc = 0xFFFFFFFFu;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? 0xEDB88320u ^ (crc >> 1) : crc >> 1;
  }
  return ~crc;
}

/// Makes the header of a picture claim side x side pixels, with all else as it was.
void forge_size(const fs::path& file, uint32_t side) {
  std::string bytes = read_text(file);
  const std::string type = file.extension().string();
  if (type == ".png") {
    for (const size_t at : {16, 20}) put(bytes, at, side, 4, true);
    put(bytes, 29, crc32_of(bytes.substr(12, 17)), 4, true);
  } else if (type == ".jpg") {
    const size_t frame = bytes.find("\xFF\xC0");
    for (const size_t at : {5, 7}) put(bytes, frame + at, side, 2, true);
  } else if (type == ".exr") {
    for (const std::string window : {"dataWindow", "displayWindow"})
      for (const size_t corner : {8, 12})
        put(bytes, bytes.find(window) + window.size() + 11 + corner, side - 1, 4, false);
  } else {
    size_t entry = 0;  // of the directory, twelve bytes each: tag, type, count, value
    std::memcpy(&entry, bytes.data() + 4, 4);
    for (entry += 2;; entry += 12) {
      const int tag = static_cast<unsigned char>(bytes[entry]) +
                      256 * static_cast<unsigned char>(bytes[entry + 1]);
      if (tag == 256 || tag == 257 || tag == 278) put(bytes, entry + 8, side, 2, false);
      if (tag >= 278) break;  // the rows of a strip, behind width and height
    }
  }
  write_text(file, bytes);
}

std::string complaint(const fs::path& file) {
  try {
    read_image(file);
    return "";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().file, file.string());
    return error.wrong();
  }
}

struct FormatCase {
  const char* name;
  OIIO::TypeDesc type;
  int quality;
  double tolerance;
  int bits;
};

class EveryPhotoFormat : public testing::TestWithParam<FormatCase> {};

TEST_P(EveryPhotoFormat, RoundTripsGreyAndColour) {
  const FormatCase& format = GetParam();
  const TemporaryFolder folder;
  for (const int channels : {1, 3}) {
    const Image image = ramp(channels);
    const fs::path file = folder / format.name;
    store(file, image, format.type, format.quality);
    const ImageHeader header = read_image_header(file);
    EXPECT_EQ(header.width, 61);
    EXPECT_EQ(header.height, 47);
    EXPECT_EQ(header.channels, channels);
    EXPECT_EQ(header.bits, format.bits);
    EXPECT_LE(largest_difference(read_image(file, Encoding{}), image), format.tolerance);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Formats, EveryPhotoFormat,
    testing::Values(FormatCase{"a.png", OIIO::TypeDesc::UINT8, 0, 0.51 / 255, 8},
                    FormatCase{"b.png", OIIO::TypeDesc::UINT16, 0, 0.51 / 65535, 16},
                    FormatCase{"c.tif", OIIO::TypeDesc::UINT8, 0, 0.51 / 255, 8},
                    FormatCase{"d.tif", OIIO::TypeDesc::UINT16, 0, 0.51 / 65535, 16},
                    FormatCase{"e.tif", OIIO::TypeDesc::FLOAT, 0, 0, 32},
                    FormatCase{"f.exr", OIIO::TypeDesc::FLOAT, 0, 0, 32},
                    FormatCase{"g.exr", OIIO::TypeDesc::HALF, 0, 5e-4, 16}));

/// The values of a file in floats, by the library.
std::vector<float> by_library(const fs::path& file, size_t count) {
  std::vector<float> values(count);
  const auto input = OIIO::ImageInput::open(file.string());
  EXPECT_TRUE(input && input->read_image(0, 0, 0, -1, OIIO::TypeDesc::FLOAT, values.data()));
  return values;
}

/// Codes are looked up in a table: to the last bit what the library and the formula say.
TEST(ImageTest, CodesStandForWhatTheLibraryReads) {
  const TemporaryFolder folder;
  Image all{256, 256, 1, std::vector<float>(65536)};  // every code of 16 bits, and of 8
  for (size_t i = 0; i < all.values.size(); ++i) all.values[i] = static_cast<float>(i) / 65535.0f;
  const Encoding gamma{Encoding::Kind::gamma, 2.2};
  for (const char* name : {"a.png", "b.tif"})
    for (const auto type : {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16}) {
      const fs::path file = folder / name;
      store(file, all, type);
      std::vector<float> values = by_library(file, all.values.size());
      EXPECT_EQ(read_image(file, Encoding{}).values, values) << name;
      for (float& value : values) value = static_cast<float>(std::pow(double(value), 2.2));
      EXPECT_EQ(read_image(file, gamma).values, values) << name;
    }
}

TEST(ImageTest, JpegIsReadWithinItsLoss) {
  const TemporaryFolder folder;
  for (const int channels : {1, 3}) {
    Image smooth{64, 48, channels, {}};
    smooth.values.resize(smooth.pixels() * channels);
    for (size_t i = 0; i < smooth.values.size(); ++i)
      smooth.values[i] =
          0.2f + 0.5f * static_cast<float>(i) / static_cast<float>(smooth.values.size());
    store(folder / "a.jpg", smooth, OIIO::TypeDesc::UINT8, 98);
    EXPECT_LE(largest_difference(read_image(folder / "a.jpg", Encoding{}), smooth), 0.02);
  }
}

TEST(ImageTest, EncodingsAreUndone) {
  const TemporaryFolder folder;
  const Image image = ramp(1);
  const Encoding srgb{Encoding::Kind::srgb, 1.0}, gamma{Encoding::Kind::gamma, 2.2};
  for (const Encoding& encoding : {Encoding{}, srgb, gamma}) {
    write_image(folder / "a.tif", image, encoding);
    EXPECT_LE(largest_difference(read_image(folder / "a.tif", encoding), image), 2e-5);
  }
  // Stored 188 of 255 is half of full scale in sRGB (IEC 61966-2-1).
  Image half{1, 1, 1, {188 / 255.0f}};
  store(folder / "b.png", half, OIIO::TypeDesc::UINT8);
  EXPECT_NEAR(read_image(folder / "b.png").at(0, 0), 0.5029, 1e-4) << "8 bit is sRGB by default";
  EXPECT_NEAR(read_image(folder / "b.png", Encoding{}).at(0, 0), 188 / 255.0, 1e-6);
  EXPECT_NEAR(read_image(folder / "b.png", gamma).at(0, 0), std::pow(188 / 255.0, 2.2), 1e-6);
  store(folder / "c.png", half, OIIO::TypeDesc::UINT16);
  EXPECT_NEAR(read_image(folder / "c.png").at(0, 0), 188 / 255.0, 1e-5) << "16 bit is linear";
}

TEST(ImageTest, WrittenPicturesComeBack) {
  const TemporaryFolder folder;
  Image image = ramp(3);
  image.at(3, 4, 1) = -0.5f;
  image.at(5, 4, 2) = 7.0f;
  write_image(folder / "a.exr", image);
  EXPECT_EQ(largest_difference(read_image(folder / "a.exr"), image), 0);
  write_image(folder / "a.png", image);
  EXPECT_EQ(read_image(folder / "a.png", Encoding{}).at(5, 4, 2), 1) << "clamped";
  size_t count = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path())) ++count;
  EXPECT_EQ(count, 2u) << "no temporary file is left";
  EXPECT_THROW(write_image(folder / "a.bmp", image), std::invalid_argument);
  EXPECT_THROW(write_image(folder / "nowhere/a.png", image), std::runtime_error);
}

TEST(ImageTest, AlphaIsDroppedNotMultiplied) {
  const TemporaryFolder folder;
  Image image{2, 1, 4, {1, 0.5f, 0.25f, 0, 1, 0.5f, 0.25f, 1}};
  for (const char* name : {"a.png", "a.tif"}) {
    auto output = OIIO::ImageOutput::create((folder / name).string());
    OIIO::ImageSpec spec(2, 1, 4, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    output->open((folder / name).string(), spec);
    output->write_image(OIIO::TypeDesc::FLOAT, image.values.data());
    output->close();
    const Image read = read_image(folder / name, Encoding{});
    ASSERT_EQ(read.channels, 3);
    EXPECT_EQ(read.at(0, 0, 0), 1) << name;
    EXPECT_NEAR(read.at(0, 0, 2), 0.25, 0.002) << name;
  }
}

TEST(ImageTest, TruncatedPicturesAreRefused) {
  const TemporaryFolder folder;
  Image noise = ramp(3);
  std::mt19937 random(3);
  for (float& v : noise.values) v = static_cast<float>(random() % 1000) / 1000.0f;
  for (const char* name : {"a.png", "a.jpg", "a.tif", "a.exr"}) {
    const fs::path whole = folder / name;
    store(whole, noise, name[2] == 'e' ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
    ASSERT_EQ(complaint(whole), "") << name;
    const std::string bytes = read_text(whole);
    for (const double part : {0.0, 0.001, 0.02, 0.2, 0.5, 0.9}) {
      const fs::path cut = folder / (std::string("cut") + whole.extension().string());
      write_text(cut,
                 bytes.substr(0, static_cast<size_t>(part * static_cast<double>(bytes.size()))));
      EXPECT_NE(complaint(cut), "") << name << " cut at " << part;
    }
  }
}

TEST(ImageTest, HugeClaimsAreRefusedBeforeAllocation) {
  const TemporaryFolder folder;
  // A portable float map's header is text: the claim costs nothing to write.
  write_text(folder / "a.ppm", "P6\n60000 60000\n255\nxxxx");
  EXPECT_EQ(complaint(folder / "a.ppm"), "the header claims 60000 x 60000 pixels with 3 channels");
  write_text(folder / "b.ppm", "P6\n30000 30000\n255\nxxxx");
  EXPECT_EQ(complaint(folder / "b.ppm"), "the header claims 30000 x 30000 pixels with 3 channels");
}

/// A few hundred bytes that claim almost two gigabytes, in every format.
TEST(ImageTest, ClaimsAreHeldAgainstTheSizeOfTheFile) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.tif", "a.exr", "a.jpg"}) {
    const fs::path file = folder / name;
    const bool exr = file.extension() == ".exr";
    store(file, {16, 16, 1, std::vector<float>(256, 0.5f)},
          exr ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::UINT8);
    const std::string told = std::to_string(fs::file_size(file));
    forge_size(file, 22000);
    EXPECT_EQ(complaint(file), exr ? "the file cannot be read as a picture"  // OpenEXR's own check
                                   : "the header claims 22000 x 22000 pixels with 1 channels, "
                                     "which " +
                                         told + " bytes cannot hold");
    EXPECT_THROW(read_image_header(file), InputError);
  }
}

/// What compresses best is no claim: one level all over, in 8 bits and in 16.
TEST(ImageTest, EvenPicturesAreNoForgeries) {
  const TemporaryFolder folder;
  const Image even{3000, 2000, 1, std::vector<float>(6000000, 0.5f)};
  for (const auto& type : {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16})
    for (const char* name : {"a.png", "a.tif"}) {
      store(folder / name, even, type);
      EXPECT_EQ(complaint(folder / name), "") << name;
    }
  store(folder / "a.exr", even, OIIO::TypeDesc::FLOAT);
  EXPECT_EQ(complaint(folder / "a.exr"), "");
  store(folder / "a.jpg", even, OIIO::TypeDesc::UINT8, 1);
  EXPECT_EQ(complaint(folder / "a.jpg"), "");
}

/// A changed byte in the pixels of a PNG is found before libpng tells it on standard error.
TEST(ImageTest, DamagedPngsAreToldOnce) {
  const TemporaryFolder folder;
  store(folder / "a.png", ramp(3), OIIO::TypeDesc::UINT8);
  const std::string whole = read_text(folder / "a.png");
  for (const size_t at : {size_t{17}, size_t{30}, whole.size() / 2, whole.size() - 20}) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x55);
    write_text(folder / "b.png", bytes);
    testing::internal::CaptureStderr();
    EXPECT_NE(complaint(folder / "b.png"), "") << at;
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << at;
  }
}

TEST(ImageTest, PixelsThatAreNoNumbersAreNamed) {
  const TemporaryFolder folder;
  Image image = ramp(3);
  image.at(7, 11, 2) = std::numeric_limits<float>::quiet_NaN();
  store(folder / "a.exr", image, OIIO::TypeDesc::FLOAT);
  EXPECT_EQ(complaint(folder / "a.exr"), "pixel (7, 11) holds not a number");
  image.at(7, 11, 2) = -std::numeric_limits<float>::infinity();
  store(folder / "a.exr", image, OIIO::TypeDesc::FLOAT);
  EXPECT_EQ(complaint(folder / "a.exr"), "pixel (7, 11) holds infinity");
}

TEST(ImageTest, FaultsAreToldWhereTheCaptureNamesThePicture) {
  const TemporaryFolder folder;
  store(folder / "a.png", ramp(1), OIIO::TypeDesc::UINT8);
  fs::resize_file(folder / "a.png", fs::file_size(folder / "a.png") / 2);
  try {
    read_image(NamedFile{folder / "a.png", {"capture.yaml", 8, 20}});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "capture.yaml:8:20: a.png: the picture is truncated or damaged\n"
                 "  hand over a complete PNG, TIFF, JPEG or EXR picture");
  }
}

TEST(ImageTest, OtherFaultsAreNamed) {
  const TemporaryFolder folder;
  EXPECT_EQ(complaint(folder / "none.png"), "there is no such file");
  EXPECT_EQ(complaint(folder.path()), "this is not a file");
  write_text(folder / "text.png", "hello");
  EXPECT_EQ(complaint(folder / "text.png"), "the file cannot be read as a picture");
  store(folder / "turned.jpg", ramp(3), OIIO::TypeDesc::UINT8, 0, 6);
  EXPECT_EQ(complaint(folder / "turned.jpg"), "the picture carries the orientation tag 6");
}

TEST(NoiseTest, ModelIsAffineInIntensity) {
  const NoiseModel noise{20000, 0.001, false};
  EXPECT_DOUBLE_EQ(noise.sigma(0), 0.001);
  EXPECT_DOUBLE_EQ(noise.sigma(0.5), std::sqrt(1e-6 + 0.5 / 20000));
  EXPECT_DOUBLE_EQ(noise.sigma(-3), 0.001);
  EXPECT_DOUBLE_EQ((NoiseModel{0, 0.01, false}).sigma(1), 0.01);
}

TEST(NoiseTest, LuminanceIsRec709) {
  const Image colour{1, 1, 3, {1, 0.5f, 0.25f}};
  EXPECT_NEAR(luminance(colour).at(0, 0), 0.2126 + 0.5 * 0.7152 + 0.25 * 0.0722, 1e-6);
  EXPECT_EQ(luminance(colour).channels, 1);
}

/// A smooth shading with blobs of texture over half the picture, and noise of a known law.
Image noisy_scene(const NoiseModel& law, bool textured, int channels) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  Image image{400, 300, channels, {}};
  image.values.resize(image.pixels() * channels);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < channels; ++c) {
        double v = 0.08 + 0.75 * x / image.width;
        if (textured && y > 150) v *= 1 + 0.15 * std::sin(x / 5.0) * std::cos(y / 4.0);
        image.at(x, y, c) = static_cast<float>(v + law.sigma(v) * normal(random));
      }
  return image;
}

TEST(NoiseTest, EstimateFindsTheLaw) {
  for (const NoiseModel& law : {NoiseModel{20000, 0.0011, false}, NoiseModel{2000, 0.004, false},
                                NoiseModel{0, 0.01, false}})
    for (const bool textured : {false, true})
      for (const int channels : {1, 3}) {
        const NoiseModel found = estimate_noise(noisy_scene(law, textured, channels));
        EXPECT_TRUE(found.estimated);
        for (const double intensity : {0.15, 0.4, 0.7})
          EXPECT_NEAR(found.sigma(intensity) / law.sigma(intensity), 1, 0.08)
              << "full well " << law.full_well << ", textured " << textured << ", at " << intensity;
      }
}

TEST(NoiseTest, EstimateOfAFlatOrTinyPictureIsZero) {
  Image flat{100, 100, 1, std::vector<float>(10000, 0.5f)};
  EXPECT_NEAR(estimate_noise(flat).sigma(0.5), 0, 1e-6);
  Image tiny{3, 3, 1, std::vector<float>(9, 0.5f)};
  EXPECT_EQ(estimate_noise(tiny).sigma(0.5), 0);
}

}  // namespace
}  // namespace hookeye::test
