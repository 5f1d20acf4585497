// hookeye import VIDEO: frames as photos, with the times by which they are paired with a table.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/commands/import_files.h"
#include "core/scope.h"
#include "importers/video.h"

namespace hookeye {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

/// Photos on their way into the folder: all of them get there, or none.
class Arriving {
 public:
  explicit Arriving(const fs::path& folder) : folder_(folder), part_(folder / ".hookeye-frames") {
    std::error_code error;
    fs::remove_all(part_, error);  // of one that was killed
    for (fs::path one = folder; !one.empty() && !fs::exists(one, error); one = one.parent_path())
      fresh_.push_back(one);
    fs::create_directories(part_, error);
    if (error) throw cannot_write(part_.string(), error.message());
  }
  ~Arriving() {
    std::error_code ignored;
    fs::remove_all(part_, ignored);
    for (const fs::path& one : fresh_) fs::remove(one, ignored);  // where it has stayed empty
  }
  Arriving(const Arriving&) = delete;
  Arriving& operator=(const Arriving&) = delete;
  const fs::path& part() const { return part_; }
  void arrived(const std::vector<VideoPhoto>& photos) const {
    for (const VideoPhoto& photo : photos) fs::rename(part_ / photo.name, folder_ / photo.name);
  }

 private:
  fs::path folder_, part_;
  std::vector<fs::path> fresh_;  ///< folders that were not there
};

void refuse_photos_there(const fs::path& folder, const std::vector<Video>& videos) {
  std::error_code error;
  for (const fs::directory_entry& one : fs::directory_iterator(folder, error))
    for (const Video& video : videos)
      if (one.path().filename().string().starts_with(video.camera + "_"))
        throw InputError({one.path().string()}, "photos of a camera of this name are there",
                         "another folder behind -o, or move them away");
}

std::string in_one_line(const Video& video, const std::vector<VideoPhoto>& photos) {
  return fmt::format(
             "{}: a video, {} x {} px, {} frames in {:.4g} s, {}{} bits\n  {} of them are {}",
             video.file.string(), video.width, video.height, video.times.size(), video.lasts(),
             video.channels == 1 ? "grey, " : "", video.bits, photos.size(), photos.front().name) +
         (photos.size() > 1 ? " to " + photos.back().name : "") + "\n";
}

}  // namespace

void run_import_videos(const std::vector<fs::path>& files, const FrameChoice& choice,
                       const fs::path& folder, Session& session) {
  const Scope scope("source " + files.front().string());
  std::vector<Video> videos;
  for (const fs::path& file : files) videos.push_back(look_at_video(file));
  const std::vector<FrameRow> rows = choose_frames(videos, choice);
  const fs::path photos_folder = folder / "photos";
  refuse_photos_there(photos_folder, videos);
  const Arriving arriving(photos_folder);
  std::vector<std::vector<VideoPhoto>> photos;
  for (size_t v = 0; v < videos.size(); ++v)
    photos.push_back(photos_of_video(videos[v], rows, v, arriving.part()));
  for (const auto& of_one : photos) arriving.arrived(of_one);

  session.document = {
      {"hookeye", 1}, {"command", "import"}, {"kind", "video"}, {"videos", Json::array()}};
  for (size_t v = 0; v < videos.size(); ++v) {
    Json one = {{"file", videos[v].file.string()},
                {"camera", videos[v].camera},
                {"size", {videos[v].width, videos[v].height}},
                {"frames", videos[v].times.size()},
                {"photos", Json::array()},
                {"said", videos[v].said}};
    for (const VideoPhoto& photo : photos[v])
      one["photos"].push_back(
          {{"file", (photos_folder / photo.name).string()}, {"seconds", photo.seconds}});
    session.document["videos"].push_back(std::move(one));
    session.say("{}", in_one_line(videos[v], photos[v]));
    for (const std::string& said : videos[v].said) session.say("{}", wrapped(said, 2));
  }
  const auto [shortest, longest] = std::minmax_element(
      videos.begin(), videos.end(), [](auto& a, auto& b) { return a.lasts() < b.lasts(); });
  if (longest->lasts() > 1.05 * shortest->lasts())
    session.warn(fmt::format(
        "{} ends {:.4g} s before {}: of what came after that there is no photo",
        shortest->file.string(), longest->lasts() - shortest->lasts(), longest->file.string()));
  if (videos.size() > 1)
    session.say("{}",
                wrapped(fmt::format("photos of one number are of one time from the first frames "
                                    "on, within {:.2g} s: the videos have to begin together",
                                    farthest_apart(videos, rows)),
                        2));
  session.say("{}",
              wrapped(fmt::format("written to {}; their EXIF data have the time from the first "
                                  "frame on. Beside a machine's table, `hookeye new {}` pairs "
                                  "them with its rows",
                                  photos_folder.string(), folder.string()),
                      0));
}

}  // namespace hookeye
