// Is there a photo at rest where one is needed: for the texture, and for the noise floor?
#include <fmt/format.h>

#include <set>

#include "estimation/inspection/question.h"

namespace hookeye::inspection {

namespace {

/// Cameras whose photos count for nothing, as none of theirs gives the texture.
void ask_of_texture(Sight& sight, Warnings& warnings) {
  const BodySpec& body = sight.scene().capture.body;
  if (body.texture != BodySpec::Texture::rest) return;
  std::set<std::string> painted;
  const int source = sight.scene().example_index(body.texture_example);
  for (const PhotoIndex& photo : sight.photos())
    if (photo.first == source) painted.insert(sight.spec(photo).camera);
  for (const PhotoIndex& photo : sight.photos()) {
    const PhotoSpec& spec = sight.spec(photo);
    if (spec.kind != PhotoSpec::Kind::image || !painted.insert(spec.camera).second) continue;
    warnings.say(
        spec.place,
        fmt::format("camera `{}` has no photo in example `{}`, which gives the texture: its "
                    "other photos cannot be compared",
                    spec.camera, body.texture_example),
        fmt::format("a photo by it in example `{}`", body.texture_example));
  }
}

}  // namespace

void ask_rest_photos(Sight& sight, Warnings& warnings) {
  ask_of_texture(sight, warnings);
  bool image = false, rest = false;
  std::set<int> examples;
  for (const PhotoIndex& photo : sight.photos()) {
    image |= sight.spec(photo).kind == PhotoSpec::Kind::image;
    rest |= is_rest(sight.example(photo.first));
    examples.insert(photo.first);
  }
  // One state alone may be all that there is to photograph: a body that hangs.
  if (!image || rest || examples.size() < 2) return;
  warnings.say(
      warnings.place({"examples"}),
      "no photo shows the body at rest: what noise, texture and renderer leave without any "
      "load (the noise floor) is not known, and a missing effect cannot be told from it",
      "an example without loads and moved supports, photographed by every camera");
}

}  // namespace hookeye::inspection
