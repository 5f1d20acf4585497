// Frames of videos as photos: what ffprobe says of one, which frames are taken, and both programs
// on videos that ffmpeg made from known codes.
#include "importers/video.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "capture_io/coded_photo.h"
#include "capture_io/image.h"
#include "capture_io/photo_time.h"
#include "core/program.h"
#include "importers/published.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// As ffprobe 5.1 writes it: packets by the decoder's order, one that is not shown.
std::string probed(const std::string& stream) {
  return R"({"packets": [
    {"pts_time": "0.000000", "flags": "K_"}, {"pts_time": "0.160000", "flags": "__"},
    {"pts_time": "0.080000", "flags": "__"}, {"pts_time": "-0.040000", "flags": "_D"},
    {"pts_time": "0.040000", "flags": "__"}, {"flags": "__"}], "programs": [], "streams": [{)" +
         stream + "}]}";
}

TEST(Video, IsWhatFfprobeSaysOfIt) {
  const Video video = video_of("lab/cam 0.mp4", probed(R"("codec_name": "h264", "width": 320,
      "height": 240, "pix_fmt": "yuv420p10le", "field_order": "tt",
      "side_data_list": [{"rotation": -90}])"));
  EXPECT_EQ(video.camera, "cam_0");
  EXPECT_EQ(video.width, 240);
  EXPECT_EQ(video.height, 320);
  EXPECT_EQ(video.channels, 3);
  EXPECT_EQ(video.bits, 16);
  EXPECT_FALSE(video.bt709);
  EXPECT_THAT(video.times, ElementsAre(0, 0.04, 0.08, 0.16));
  EXPECT_THAT(video.said, ElementsAre(HasSubstr("turned by -90 degrees"), HasSubstr("interlaced"),
                                      HasSubstr("compressed (h264)")));
  const Video grey = video_of("a.avi", probed(R"("codec_name": "ffv1", "width": 2000,
      "height": 1000, "pix_fmt": "gray")"));
  EXPECT_EQ(grey.channels, 1);
  EXPECT_EQ(grey.bits, 8);
  EXPECT_TRUE(grey.bt709);
  EXPECT_THAT(grey.said, IsEmpty());
  EXPECT_TRUE(video.srgb);
  EXPECT_FALSE(grey.srgb);
  EXPECT_FALSE(video_of("a.mp4", probed(R"("codec_name": "h264", "width": 320, "height": 240,
      "pix_fmt": "gray", "color_transfer": "linear")"))
                   .srgb);
}

TEST(Video, WithoutFramesIsRefused) {
  const auto refused = [](const std::string& json) {
    return complaint(".", [&] { video_of("a.mp4", json); });
  };
  const std::string size = R"("width": 320, "height": 240)";
  EXPECT_THAT(refused(""), HasSubstr("a.mp4: there are no frames"));
  EXPECT_THAT(refused("[1]"), HasSubstr("there are no frames"));
  EXPECT_THAT(refused(R"({"streams": [{)" + size + "}]}"), HasSubstr("there are no frames"));
  EXPECT_THAT(refused(R"({"packets": [{"pts_time": "N/A"}], "streams": [{)" + size + "}]}"),
              HasSubstr("there are no frames"));
  EXPECT_THAT(refused(probed(R"("width": 0, "height": 240)")), HasSubstr("have no size"));
}

Video of(const std::string& camera, double first, double pace, int frames) {
  Video video;
  video.file = camera + ".mp4";
  video.camera = camera;
  for (int k = 0; k < frames; ++k) video.times.push_back(first + pace * k);
  return video;
}

std::vector<size_t> column(const std::vector<FrameRow>& rows, size_t video) {
  std::vector<size_t> out;
  for (const FrameRow& row : rows) out.push_back(row.frames[video]);
  return out;
}

TEST(Video, FramesAreOfOneTimeInAllCameras) {
  const std::vector<Video> two = {of("left", 3.0, 0.04, 101), of("right", 0.0, 0.1, 51)};
  const auto five = choose_frames(two, {.count = 5});
  EXPECT_THAT(column(five, 0), ElementsAre(0, 25, 50, 75, 100));
  EXPECT_THAT(column(five, 1), ElementsAre(0, 10, 20, 30, 40));
  EXPECT_NEAR(farthest_apart(two, five), 0, 1e-9);
  const auto paced = choose_frames(two, {.every = 1.5});
  EXPECT_THAT(column(paced, 0), ElementsAre(0, 37, 75));
  EXPECT_NEAR(farthest_apart(two, paced), 0.02, 1e-9);
  const auto told = choose_frames(two, {.at = {2.0, 0.5}});
  EXPECT_THAT(column(told, 0), ElementsAre(12, 50));
  // as many as the slower camera has, each once
  EXPECT_EQ(choose_frames(two, {.count = 1000}).size(), 41u);
  EXPECT_THAT(complaint(".", [&] { choose_frames(two, {.at = {4.5}}); }),
              HasSubstr("left.mp4: it has no frame at 4.5 s: it lasts 4 s"));
  EXPECT_THAT(complaint(".",
                        [&] {
                          choose_frames({two[0], two[0]}, {});
                        }),
              HasSubstr("another video has this name"));
}

TEST(Program, IsRunToItsEnd) {
  std::string out;
  const auto gather = [&](std::string_view part) {
    out += part;
    return true;
  };
  const ProgramEnd end = run_program({"sh", "-c", "echo one; echo two >&2; exit 3"}, gather);
  EXPECT_TRUE(end.found);
  EXPECT_EQ(end.status, 3);
  EXPECT_EQ(out, "one\n");
  EXPECT_EQ(end.errors, "two\n");
  EXPECT_FALSE(run_program({"no-such-program-of-hookeye"}, gather).found);
  EXPECT_EQ(run_program({"sh", "-c", "kill -TERM $$"}, gather).status, 128 + 15);
  // one that would never end
  EXPECT_EQ(run_program({"yes"}, [](std::string_view) { return false; }).status, -1);
  EXPECT_THROW(run_program({"yes"}, [](std::string_view) -> bool { throw 1; }), int);
}

/// 40 x 30 px; frame k is at k^2 / 20 s.
class MadeVideo : public testing::Test {
 protected:
  static constexpr int kWidth = 40, kHeight = 30, kFrames = 12;
  void SetUp() override {
    if (!run_program({"ffmpeg", "-version"}, [](std::string_view) { return true; }).found)
      GTEST_SKIP() << "NOT RUN: ffmpeg is not installed (apt-get install ffmpeg)";
  }
  static uint8_t code(int frame, int x, int y, int c) {
    return static_cast<uint8_t>(20 + 12 * frame + 2 * x + (c == 1 ? y : 0) + 10 * c);
  }
  /// From codes of rgb24 or gray.
  std::filesystem::path made(const std::string& name, const std::string& from,
                             const std::vector<std::string>& by) const {
    const int channels = from == "gray" ? 1 : 3;
    std::ofstream raw(folder_ / "raw", std::ios::binary);
    for (int k = 0; k < kFrames; ++k)
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
          for (int c = 0; c < channels; ++c) raw.put(static_cast<char>(code(k, x, y, c)));
    raw.close();
    std::vector<std::string> words = {
        "ffmpeg", "-nostdin",   "-v",       "error", "-y",
        "-f",     "rawvideo",   "-pix_fmt", from,    "-s",
        "40x30",  "-framerate", "20",       "-i",    (folder_ / "raw").string()};
    words.insert(words.end(), {"-vf", "setpts=N*N/(20*TB)", "-fps_mode", "passthrough"});
    words.insert(words.end(), by.begin(), by.end());
    words.push_back((folder_ / name).string());
    const ProgramEnd end = run_program(words, [](std::string_view) { return true; });
    EXPECT_EQ(end.status, 0) << end.errors;
    return folder_ / name;
  }
  /// Largest distance of a code from what it was made of; of codes of 16 bits in those of 8.
  double farthest(const std::filesystem::path& photo, int frame, int channels) const {
    const Image image = read_image(photo, Encoding{Encoding::Kind::linear, 1.0});
    EXPECT_EQ(image.width, kWidth);
    EXPECT_EQ(image.channels, channels);
    double most = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (int c = 0; c < channels; ++c) {
          const auto at = static_cast<size_t>((y * kWidth + x) * channels + c);
          most = std::max(most, std::abs(255.0 * image.values[at] - code(frame, x, y, c)));
        }
    return most;
  }
  TemporaryFolder folder_;
};

TEST_F(MadeVideo, OfLosslessFramesHasTheirCodesAndTimes) {
  for (const std::string& from : {std::string("gray"), std::string("rgb24")}) {
    const int channels = from == "gray" ? 1 : 3;
    const auto by = from == "gray" ? std::vector<std::string>{"-c:v", "ffv1"}
                                   : std::vector<std::string>{"-c:v", "ffv1", "-pix_fmt", "bgr0"};
    const Video video = look_at_video(made("cam0.mkv", from, by));
    ASSERT_EQ(video.times.size(), size_t{kFrames});
    EXPECT_EQ(video.channels, channels);
    EXPECT_THAT(video.said, IsEmpty());
    const auto rows = choose_frames({video}, {.at = {0.0, 0.8, 6.05}});
    const auto photos = photos_of_video(video, rows, 0, folder_.path());
    ASSERT_EQ(photos.size(), 3u);
    const int frames[] = {0, 4, 11};
    for (size_t k = 0; k < 3; ++k) {
      const auto file = folder_ / photos[k].name;
      EXPECT_EQ(photos[k].name, "cam0_000" + std::to_string(k + 1) + ".tif");
      EXPECT_LT(farthest(file, frames[k], channels), 1e-3);
      // Matroska's clock has thousandths
      EXPECT_NEAR(photos[k].seconds, 0.05 * frames[k] * frames[k], 1e-3);
      const auto taken = read_photo_time(file);
      ASSERT_TRUE(taken.has_value());
      EXPECT_NEAR(taken->seconds, photos[k].seconds, 1e-6);
      EXPECT_FALSE(is_told_srgb(file));  // as of a laboratory
    }
  }
}

TEST_F(MadeVideo, OfBrightnessAndColoursIsTurnedIntoFullCodes) {
  // 16 .. 235 for brightness, and another matrix than is assumed of so small a picture
  const Video video = look_at_video(
      made("cam0.mkv", "rgb24",
           {"-vf", "setpts=N*N/(20*TB),scale=out_color_matrix=bt709:flags=accurate_rnd", "-c:v",
            "ffv1", "-pix_fmt", "yuv444p10le", "-colorspace", "bt709", "-color_trc", "bt709"}));
  EXPECT_TRUE(video.bt709);
  EXPECT_EQ(video.bits, 16);
  const auto photos =
      photos_of_video(video, choose_frames({video}, {.at = {0.8}}), 0, folder_.path());
  EXPECT_LT(farthest(folder_ / photos.at(0).name, 4, 3), 1.0);
  EXPECT_TRUE(is_told_srgb(folder_ / photos.at(0).name));
}

TEST_F(MadeVideo, ThatIsCutOrNoneIsRefused) {
  const auto whole = made("cam0.mkv", "gray", {"-c:v", "ffv1"});
  const Video video = look_at_video(whole);
  std::filesystem::resize_file(whole, std::filesystem::file_size(whole) / 2);
  EXPECT_THAT(complaint(folder_.path(),
                        [&] {
                          const auto rows = choose_frames({video}, {});
                          photos_of_video(video, rows, 0, folder_.path());
                        }),
              testing::ContainsRegex("cam0.mkv: it ends at [0-9]+ of the 9 frames"));
  std::ofstream(folder_ / "junk.mp4") << "no video at all";
  EXPECT_THAT(complaint(folder_.path(), [&] { look_at_video(folder_ / "junk.mp4"); }),
              HasSubstr("junk.mp4: ffprobe cannot read it: "));
}

}  // namespace
}  // namespace hookeye::test
