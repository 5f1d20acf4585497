#include "app/commands/place_tags.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "calibration/board_options.h"
#include "calibration/tags.h"
#include "placing/tags.h"

namespace hookeye {
namespace {

constexpr const char* kCorners[] = {"upper left", "upper right", "lower right", "lower left"};

struct Looked {
  const ExampleSpec* example = nullptr;
  const PhotoSpec* photo = nullptr;
  std::string told() const {
    return fmt::format("photo `{}` of example `{}`", photo->camera, example->name);
  }
};

std::vector<Looked> photos_of(const Capture& at_rest) {
  std::vector<Looked> out;
  for (const ExampleSpec& example : at_rest.examples)
    for (const PhotoSpec& photo : example.photos)
      if (photo.kind == PhotoSpec::Kind::image) out.push_back({&example, &photo});
  return out;
}

/// Another dictionary in which a told tag is seen in this photo: "5X5_100"; "": none.
std::string other_dictionary(const std::vector<BodyTag>& tags, const std::string& told,
                             const Image& photo, const std::string& file) {
  for (const std::string& name : marker_dictionaries()) {
    if (name == told) continue;
    for (const SeenTag& seen : find_tags(photo, name, file))
      if (std::ranges::any_of(tags, [&](const BodyTag& tag) { return tag.id == seen.id; }))
        return name;
  }
  return {};
}

[[noreturn]] void refuse_unseen(const std::vector<BodyTag>& tags, const std::string& dictionary,
                                const std::vector<Looked>& photos, const std::set<int>& strangers) {
  std::string right = "tags that are flat, sharp and whole in the photos at rest, with a white rim";
  if (!strangers.empty())
    right = fmt::format("the numbers of the tags: seen are {}", fmt::join(strangers, ", "));
  else if (!photos.empty()) {
    const PhotoSpec& first = *photos.front().photo;
    const std::string other =
        other_dictionary(tags, dictionary, read_image(first.file, first.encoding), first.file);
    if (!other.empty()) right = fmt::format("--dictionary {}: it has a tag in this photo", other);
  }
  throw InputError(tags.front().place,
                   fmt::format("none of these tags of {} is seen in {} photos at rest", dictionary,
                               photos.size()),
                   right);
}

}  // namespace

std::vector<PickedPair> pairs_of_tags(const std::string& file, const std::string& dictionary,
                                      const Capture& at_rest, Session& session) {
  demand_board_finder();
  if (std::ranges::count(marker_dictionaries(), dictionary) == 0)
    throw InputError({"--dictionary"}, fmt::format("`{}` is none of OpenCV's", dictionary),
                     fmt::format("one of {}", fmt::join(marker_dictionaries(), ", ")));
  const std::vector<BodyTag> tags = read_tags(file);
  const std::vector<Looked> photos = photos_of(at_rest);
  std::vector<PickedPair> pairs;
  std::set<std::string> done;  // cameras
  std::set<int> known, strangers;
  for (const Looked& look : photos) {
    if (done.contains(look.photo->camera)) continue;
    const Image image = read_image(look.photo->file, look.photo->encoding);
    for (const SeenTag& seen : find_tags(image, dictionary, look.photo->file.string())) {
      const auto tag = std::ranges::find(tags, seen.id, &BodyTag::id);
      if (tag == tags.end()) {
        strangers.insert(seen.id);
        continue;
      }
      known.insert(seen.id), done.insert(look.photo->camera);
      for (int k = 0; k < 4; ++k)
        pairs.push_back(
            {look.photo->camera,
             seen.corners.col(k),
             tag->corner(k),
             {fmt::format("{} corner of tag {} in {}", kCorners[k], seen.id, look.told())}});
    }
  }
  if (pairs.empty()) refuse_unseen(tags, dictionary, photos, strangers);
  for (const BodyTag& tag : tags)
    if (!known.contains(tag.id))
      session.warn(fmt::format("tag {} is seen in no photo at rest", tag.id));
  return pairs;
}

}  // namespace hookeye
