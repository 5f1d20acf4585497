// Videos as photos with times, by the programs ffprobe and ffmpeg, which the user has installed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/input_error.h"

namespace hookeye {

struct Video {
  std::filesystem::path file;
  std::string camera;             ///< its name without what names of photos may not have
  int width = 0, height = 0;      ///< [px] as shown
  int channels = 3, bits = 8;     ///< of the photos
  std::vector<double> times;      ///< of its frames [s] by the file's clock, rising
  bool srgb = false;              ///< codes are roots of brightness, as players take them
  bool bt709 = false;             ///< how its colours become red, green and blue
  std::vector<std::string> said;  ///< what the user is to know
  double first() const { return times.front(); }
  double lasts() const { return times.back() - times.front(); }
};

/// By its name.
bool is_video(const std::filesystem::path& file);

/// Throws InputError where ffprobe is not there, or finds no frames.
Video look_at_video(const std::filesystem::path& file);
/// What ffprobe wrote of it. Throws InputError.
Video video_of(const std::filesystem::path& file, const std::string& json);

/// Which frames: times from the first one [s], or one each `every`, or `count` evenly.
struct FrameChoice {
  int count = 100;
  std::optional<double> every = {};
  std::vector<double> at = {};
};
/// Index of a frame of each video: those of one row are of one time from the first frames on.
struct FrameRow {
  std::vector<size_t> frames;
};
/// No frame twice. Throws InputError: videos of one name, a time that not all of them have.
std::vector<FrameRow> choose_frames(const std::vector<Video>& videos, const FrameChoice& choice);
/// Farthest that frames of one row lie apart [s].
double farthest_apart(const std::vector<Video>& videos, const std::vector<FrameRow>& rows);

struct VideoPhoto {
  std::string name;    ///< of the file: CAMERA_0001.tif
  double seconds = 0;  ///< from the video's first frame
};
/// Photos of column `index` of the rows, written into the folder (write_coded_photo). Throws
/// InputError where ffmpeg is not there, or the video has fewer frames than it announces.
std::vector<VideoPhoto> photos_of_video(const Video& video, const std::vector<FrameRow>& rows,
                                        size_t index, const std::filesystem::path& folder);

}  // namespace hookeye
