// Photos: what holds for all, and those of one example.
#include <fmt/format.h>

#include <algorithm>

#include "capture_io/capture_reader.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

NoiseModel read_noise(const YamlNode& node) {
  NoiseModel noise;
  if (node.kind != YamlNode::Kind::map) {
    noise.read = read_positive(node, "noise");
    return noise;
  }
  const YamlSection section(node, "noise", {"full_well", "read"});
  const std::string right = "write `noise: {full_well: 20000, read: 0.0011}`";
  noise.full_well = read_positive(section.need("full_well", right), "full_well");
  if (const YamlNode* read = section.find("read")) noise.read = read_not_negative(*read, "read");
  return noise;
}

BackgroundSpec read_background(const YamlNode& node, const CaptureFolder& folder) {
  BackgroundSpec background;
  using Kind = BackgroundSpec::Kind;
  if (node.kind == YamlNode::Kind::map) {
    const YamlSection section(node, "background", {"photo"});
    const YamlNode& photo = section.need("photo", "write `background: {photo: empty.png}`");
    background.kind = Kind::photo;
    background.photo = read_file_path(photo, "photo of the background", folder);
    header_at(photo, background.photo);
  } else if (node.kind == YamlNode::Kind::scalar && node.text == "ignore") {
    background.kind = Kind::ignore;
  } else if (node.kind == YamlNode::Kind::scalar && node.text == "fit") {
    background.kind = Kind::fit;
  } else if (node.kind == YamlNode::Kind::scalar && node.text == "black") {
    background.kind = Kind::level;
  } else {
    background.kind = Kind::level;
    try {
      background.level = read_not_negative(node, "background");
    } catch (const InputError& error) {
      throw InputError(error.place(), error.wrong(),
                       "ignore, black, fit, a number from zero or {photo: FILE} is expected");
    }
  }
  return background;
}

/// The keys that defaults and photos share.
void read_photo_keys(const YamlSection& section, const CaptureFolder& folder, PhotoSpec& photo) {
  if (const YamlNode* kind = section.find("kind"))
    photo.kind = read_choice(*kind, "kind", {"image", "silhouette"}) == "image"
                     ? PhotoSpec::Kind::image
                     : PhotoSpec::Kind::silhouette;
  if (const YamlNode* encoding = section.find("encoding"))
    photo.encoding = read_encoding(*encoding, "encoding");
  if (const YamlNode* noise = section.find("noise")) photo.noise = read_noise(*noise);
  if (const YamlNode* channels = section.find("channels"))
    photo.rgb = read_choice(*channels, "channels", {"luminance", "rgb"}) == "rgb";
  if (const YamlNode* mask = section.find("mask")) {
    photo.mask = read_file_path(*mask, "mask", folder);
    header_at(*mask, photo.mask);
  }
  if (const YamlNode* background = section.find("background"))
    photo.background = read_background(*background, folder);
}

void check_same_size(const Place& place, const std::string& what, const ImageHeader& header,
                     const Camera& camera) {
  if (header.width != camera.width || header.height != camera.height)
    throw InputError(
        place,
        fmt::format("{} has {} x {} pixels, camera `{}` has {} x {}", what, header.width,
                    header.height, camera.name, camera.width, camera.height),
        "photos are compared at the size that the camera was calibrated for");
}

PhotoSpec read_photo_of(const YamlNode::Entry& entry, const std::string& example,
                        const Camera& camera, const PhotoDefaults& defaults,
                        const CaptureFolder& folder) {
  PhotoSpec photo = defaults.photo;
  photo.camera = camera.name;
  photo.place = entry.value.place;
  const std::string what = fmt::format("photo `{}` of example `{}`", entry.key, example);
  const YamlNode* file = &entry.value;
  Place mask_place = photo.place;
  if (entry.value.kind == YamlNode::Kind::map) {
    const YamlSection section(
        entry.value, what, {"file", "kind", "encoding", "noise", "channels", "mask", "background"});
    file = &section.need("file", "write `{file: photos/pull_left.png}`");
    const bool silhouette_here =
        section.has("kind") && section.find("kind")->text == "silhouette" && !defaults.kind_given;
    // Encoding and noise told once for all are those of the photos, not of binary masks.
    if (silhouette_here) photo.encoding.reset(), photo.noise.reset(), photo.rgb = false;
    read_photo_keys(section, folder, photo);
    if (const YamlNode* mask = section.find("mask")) mask_place = mask->place;
  }
  photo.file = read_file_path(*file, what, folder);
  const ImageHeader header = header_at(*file, photo.file);
  check_same_size(file->place, what, header, camera);
  if (photo.rgb && header.channels != 3)
    throw InputError(file->place, what + " is grey but `channels: rgb` is asked for",
                     "write `channels: luminance` or hand over a colour picture");
  if (photo.rgb && photo.kind == PhotoSpec::Kind::silhouette)
    throw InputError(photo.place, what + " is a silhouette but `channels: rgb` is asked for",
                     "a silhouette has one channel: remove `channels`");
  if (!photo.mask.empty())
    check_same_size(mask_place, "mask of " + what, read_image_header(photo.mask), camera);
  if (photo.background.kind == BackgroundSpec::Kind::photo)
    check_same_size(photo.place, "background of " + what, read_image_header(photo.background.photo),
                    camera);
  return photo;
}

}  // namespace

Encoding read_encoding(const YamlNode& node, const std::string& what) {
  if (node.kind == YamlNode::Kind::scalar && node.text == "linear") return {};
  if (node.kind == YamlNode::Kind::scalar && node.text == "srgb")
    return {Encoding::Kind::srgb, 1.0};
  try {
    return {Encoding::Kind::gamma, read_positive(node, what)};
  } catch (const InputError& error) {
    throw InputError(error.place(), error.wrong(),
                     "linear, srgb or a gamma number above zero is expected");
  }
}

ImageHeader header_at(const YamlNode& node, const fs::path& file) {
  try {
    return read_image_header(file);
  } catch (const InputError& error) {
    throw InputError(node.place, fmt::format("{}: {}", node.text, error.wrong()), error.right());
  }
}

PhotoDefaults read_photo_defaults(const YamlNode& node, const CaptureFolder& folder) {
  const YamlSection section(node, "photos",
                            {"kind", "encoding", "noise", "channels", "mask", "background"});
  PhotoDefaults defaults;
  defaults.kind_given = section.has("kind");
  read_photo_keys(section, folder, defaults.photo);
  return defaults;
}

std::vector<PhotoSpec> read_photos(const YamlNode& node, const std::string& example,
                                   const Capture& capture, const PhotoDefaults& defaults,
                                   const CaptureFolder& folder) {
  std::vector<PhotoSpec> photos;
  for (const YamlNode::Entry& entry :
       read_named(node, fmt::format("photos of example `{}`", example))) {
    const auto camera = std::find_if(capture.cameras.begin(), capture.cameras.end(),
                                     [&](const Camera& c) { return c.name == entry.key; });
    if (camera == capture.cameras.end())
      throw InputError(
          entry.place,
          fmt::format("example `{}` has a photo of the unknown camera `{}`", example, entry.key),
          suggest(entry.key, names_of(capture.cameras)));
    photos.push_back(read_photo_of(entry, example, *camera, defaults, folder));
  }
  return photos;
}

}  // namespace hookeye
