#include "importers/video.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "capture_io/coded_photo.h"
#include "core/interrupted.h"
#include "core/program.h"

namespace hookeye {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

const char* const kComplete = "hand over a complete video, or photos";

ProgramEnd run(const fs::path& file, const std::vector<std::string>& words,
               const std::function<bool(std::string_view)>& output) {
  ProgramEnd end = run_program(words, output);
  if (!end.found)
    throw InputError(
        {file.string()},
        fmt::format("videos are read by the program {}, which is not there", words.front()),
        "install it: apt-get install ffmpeg");
  if (end.status == 128 + 2 || end.status == 255) throw Interrupted{};  // Ctrl-C reaches it, too
  return end;
}

/// The last line that says something.
std::string last_line(const std::string& text) {
  const size_t end = text.find_last_not_of(" \r\n");
  if (end == std::string::npos) return "";
  const size_t begin = text.find_last_of("\r\n", end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1,
                     end - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

std::optional<double> number(const json& of, const char* key) {
  const auto found = of.find(key);
  if (found == of.end()) return {};
  if (found->is_number()) return found->get<double>();
  if (!found->is_string()) return {};
  const std::string text = found->get<std::string>();
  double value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

std::string word(const json& of, const char* key) {
  const auto found = of.find(key);
  return found != of.end() && found->is_string() ? found->get<std::string>() : "";
}

/// "yuv420p10le", "gray16be": more than 8 bits a code, but for colours packed into two bytes.
bool is_deep(const std::string& pixels) {
  const bool packed = pixels.find("565") != std::string::npos ||
                      pixels.find("555") != std::string::npos || pixels.starts_with("rgb444") ||
                      pixels.starts_with("bgr444");
  return (pixels.ends_with("le") || pixels.ends_with("be")) && !packed;
}

/// Degrees that the file asks to be turned by.
int turned_by(const json& stream) {
  if (const auto sides = stream.find("side_data_list"); sides != stream.end() && sides->is_array())
    for (const json& one : *sides)
      if (const auto degrees = number(one, "rotation")) return static_cast<int>(*degrees);
  return 0;
}

std::vector<double> times_of(const json& told) {
  std::vector<double> times;
  const auto packets = told.find("packets");
  if (packets == told.end() || !packets->is_array()) return times;
  for (const json& packet : *packets)
    if (const auto time = number(packet, "pts_time");
        time && word(packet, "flags").find('D') == std::string::npos)
      times.push_back(*time);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// Nothing is lost by the codec.
bool is_whole(const std::string& codec) {
  static const std::set<std::string> whole = {"ffv1",    "rawvideo", "huffyuv",
                                              "ffvhuff", "utvideo",  "png"};
  return whole.contains(codec);
}

/// Where the file does not say it: a video that is compressed is made for eyes. Frames without loss
/// are of cameras of laboratories, which store brightness itself.
bool holds_roots(const json& stream) {
  const std::string told = word(stream, "color_transfer");
  if (told.empty() || told == "unknown") return !is_whole(word(stream, "codec_name"));
  return told != "linear";
}

/// What makes frames worse than photos.
void say_what_is_lost(const json& stream, Video& video) {
  const std::string codec = word(stream, "codec_name"), fields = word(stream, "field_order");
  if (const int degrees = turned_by(stream); degrees % 360 != 0)
    video.said.push_back(fmt::format(
        "the file asks to be turned by {} degrees, and its frames are: the calibration has to be "
        "of frames that are turned alike",
        degrees));
  if (!fields.empty() && fields != "progressive" && fields != "unknown")
    video.said.push_back(
        "its frames are interlaced: every other line is of another moment. Record progressive "
        "frames, or take those at which nothing moves");
  if (!is_whole(codec))
    video.said.push_back(fmt::format(
        "it is compressed ({}): noise hangs together from pixel to pixel, and a fit takes it for "
        "something that is missing. Prefer frames at which the machine halts",
        codec));
}

}  // namespace

bool is_video(const fs::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static const std::set<std::string> known = {".mp4", ".m4v", ".mov",  ".avi", ".mkv",  ".webm",
                                              ".mpg", ".mts", ".mpeg", ".wmv", ".m2ts", ".cine"};
  return known.contains(ending);
}

Video video_of(const fs::path& file, const std::string& text) {
  const json told = json::parse(text, nullptr, false);
  const auto streams = told.is_object() ? told.find("streams") : told.end();
  Video video;
  video.file = file;
  video.times = times_of(told);
  if (!told.is_object() || streams == told.end() || !streams->is_array() || streams->empty() ||
      video.times.empty())
    throw InputError({file.string()}, "there are no frames of a video in it", kComplete);
  const json& stream = streams->front();
  video.width = static_cast<int>(number(stream, "width").value_or(0));
  video.height = static_cast<int>(number(stream, "height").value_or(0));
  if (video.width < 1 || video.height < 1 || video.width > 100000 || video.height > 100000)
    throw InputError({file.string()}, "its frames have no size", kComplete);
  if (std::abs(turned_by(stream)) % 180 == 90) std::swap(video.width, video.height);
  const std::string pixels = word(stream, "pix_fmt"), colours = word(stream, "color_space");
  video.channels = pixels.starts_with("gray") ? 1 : 3;
  video.bits = is_deep(pixels) ? 16 : 8;
  video.srgb = holds_roots(stream);
  // Untold, players take the matrix of high definition from 720 lines on.
  video.bt709 = colours.empty() || colours == "unknown" ? std::min(video.width, video.height) >= 720
                                                        : colours.starts_with("bt709");
  for (const char c : file.stem().string())
    video.camera += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  if (video.lasts() >= 86000.0)
    throw InputError({file.string()}, "it lasts longer than a day", "cut it");
  say_what_is_lost(stream, video);
  return video;
}

Video look_at_video(const fs::path& file) {
  std::string told;
  const ProgramEnd end = run(file,
                             {"ffprobe", "-v", "error", "-select_streams", "v:0", "-show_entries",
                              "stream=codec_name,width,height,pix_fmt,field_order,color_space,"
                              "color_transfer:stream_side_data=rotation:"
                              "packet=pts_time,flags",
                              "-of", "json", "file:" + file.string()},
                             [&](std::string_view part) {
                               told += part;
                               return true;
                             });
  if (end.status != 0)
    throw InputError({file.string()}, "ffprobe cannot read it: " + last_line(end.errors),
                     kComplete);
  Video video = video_of(file, told);
  if (const std::string line = last_line(end.errors); !line.empty())
    video.said.push_back("ffprobe says of it: " + line);
  return video;
}

namespace {

size_t nearest_frame(const Video& video, double seconds) {
  const double time = video.first() + seconds;
  const auto after = std::lower_bound(video.times.begin(), video.times.end(), time);
  if (after == video.times.begin()) return 0;
  if (after == video.times.end()) return video.times.size() - 1;
  const bool before = time - *(after - 1) <= *after - time;
  return static_cast<size_t>(after - video.times.begin()) - (before ? 1 : 0);
}

std::vector<double> times_by(const FrameChoice& choice, const std::vector<Video>& videos) {
  const auto shortest = std::min_element(videos.begin(), videos.end(),
                                         [](auto& a, auto& b) { return a.lasts() < b.lasts(); });
  const double lasts = shortest->lasts();
  const double pace = lasts / static_cast<double>(std::max<size_t>(shortest->times.size(), 2) - 1);
  std::vector<double> out;
  if (!choice.at.empty()) {
    for (const double time : choice.at) {
      if (time < 0 || time > lasts + pace)
        throw InputError({shortest->file.string()},
                         fmt::format("it has no frame at {:.6g} s: it lasts {:.6g} s", time, lasts),
                         "times count from the first frame on");
      out.push_back(time);
    }
    return out;
  }
  const int most = static_cast<int>(std::min<size_t>(shortest->times.size(), 100000));
  const int count = choice.every ? static_cast<int>(std::min(lasts / *choice.every, 1e5) + 1e-9) + 1
                                 : std::min(choice.count, most);
  for (int k = 0; k < count; ++k)
    out.push_back(choice.every ? k * *choice.every : count < 2 ? 0.0 : lasts * k / (count - 1));
  return out;
}

}  // namespace

std::vector<FrameRow> choose_frames(const std::vector<Video>& videos, const FrameChoice& choice) {
  std::set<std::string> names;
  for (const Video& video : videos)
    if (!names.insert(video.camera).second)
      throw InputError({video.file.string()},
                       "another video has this name, which is to be its camera's",
                       "name each file as its camera");
  std::vector<FrameRow> out;
  for (const double time : times_by(choice, videos)) {
    FrameRow row;
    for (const Video& video : videos) row.frames.push_back(nearest_frame(video, time));
    const bool again = std::any_of(out.begin(), out.end(), [&](const FrameRow& one) {
      for (size_t v = 0; v < videos.size(); ++v)
        if (one.frames[v] == row.frames[v]) return true;
      return false;
    });
    if (!again) out.push_back(std::move(row));
  }
  std::sort(out.begin(), out.end(),
            [](auto& a, auto& b) { return a.frames.front() < b.frames.front(); });
  return out;
}

double farthest_apart(const std::vector<Video>& videos, const std::vector<FrameRow>& rows) {
  double out = 0;
  for (const FrameRow& row : rows) {
    const double first = videos[0].times[row.frames[0]] - videos[0].first();
    for (size_t v = 1; v < videos.size(); ++v)
      out = std::max(out, std::abs(videos[v].times[row.frames[v]] - videos[v].first() - first));
  }
  return out;
}

namespace {

/// The frames, in their order, as they come out of a pipe.
class FrameWriter {
 public:
  FrameWriter(const Video& video, const std::vector<size_t>& frames, const fs::path& folder)
      : video_(video), frames_(frames), folder_(folder) {
    photo_.width = video.width, photo_.height = video.height;
    photo_.channels = video.channels, photo_.bits = video.bits;
    photo_.srgb = video.srgb;
    size_ = static_cast<size_t>(video.width) * static_cast<size_t>(video.height) *
            static_cast<size_t>(video.channels) * static_cast<size_t>(video.bits / 8);
  }
  bool take(std::string_view part) {
    while (!part.empty() && written.size() < frames_.size()) {
      const size_t more = std::min(part.size(), size_ - photo_.codes.size());
      photo_.codes += part.substr(0, more);
      part.remove_prefix(more);
      if (photo_.codes.size() == size_) write();
    }
    return true;
  }
  std::vector<VideoPhoto> written;

 private:
  void write() {
    photo_.seconds = video_.times[frames_[written.size()]] - video_.first();
    VideoPhoto one{fmt::format("{}_{:04}.tif", video_.camera, written.size() + 1), photo_.seconds};
    write_coded_photo(folder_ / one.name, photo_);
    photo_.codes.clear();
    written.push_back(std::move(one));
  }
  const Video& video_;
  const std::vector<size_t>& frames_;
  const fs::path folder_;
  CodedPhoto photo_;
  size_t size_ = 0;
};

/// Half an interval around each: the decoder's times are told in units of the file's clock.
std::string selection(const Video& video, const std::vector<size_t>& frames) {
  std::string out;
  for (const size_t frame : frames) {
    const double time = video.times[frame];
    const double low = frame == 0 ? time - 1.0 : 0.5 * (time + video.times[frame - 1]);
    const double high =
        frame + 1 == video.times.size() ? time + 1.0 : 0.5 * (time + video.times[frame + 1]);
    out += fmt::format("{}between(t\\,{:.9f}\\,{:.9f})", out.empty() ? "" : "+", low, high);
  }
  return out;
}

}  // namespace

std::vector<VideoPhoto> photos_of_video(const Video& video, const std::vector<FrameRow>& rows,
                                        size_t index, const fs::path& folder) {
  std::vector<size_t> frames;
  for (const FrameRow& row : rows) frames.push_back(row.frames[index]);
  FrameWriter writer(video, frames, folder);
  const bool deep = video.bits > 8;
  const char* const codes = video.channels == 1 ? (deep ? "gray16" : "gray")
                            : deep              ? "rgb48"
                                                : "rgb24";
  const std::string order = !deep ? "" : std::endian::native == std::endian::little ? "le" : "be";
  const ProgramEnd end =
      run(video.file,
          {"ffmpeg",
           "-nostdin",
           "-hide_banner",
           "-nostats",
           "-v",
           "error",
           "-copyts",
           "-i",
           "file:" + video.file.string(),
           "-map",
           "0:v:0",
           "-vf",
           fmt::format("select='{}',scale=in_color_matrix={}:out_range=full:flags=accurate_rnd+"
                       "full_chroma_int+bicubic",
                       selection(video, frames), video.bt709 ? "bt709" : "bt601"),
           "-fps_mode",
           "passthrough",
           "-f",
           "rawvideo",
           "-pix_fmt",
           codes + order,
           "pipe:1"},
          [&](std::string_view part) { return writer.take(part); });
  if (writer.written.size() < frames.size())
    throw InputError(
        {video.file.string()},
        fmt::format("it ends at {} of the {} frames that were asked for{}", writer.written.size(),
                    frames.size(), end.errors.empty() ? "" : ": " + last_line(end.errors)),
        kComplete);
  if (end.status != 0)
    throw InputError({video.file.string()}, "ffmpeg cannot read it: " + last_line(end.errors),
                     kComplete);
  return std::move(writer.written);
}

}  // namespace hookeye
