// Is a photo there twice, under two names or in two places?
#include <fmt/format.h>

#include <functional>
#include <map>
#include <string_view>

#include "estimation/inspection/question.h"

namespace hookeye::inspection {

void ask_equal_photos(Sight& sight, Warnings& warnings) {
  std::map<size_t, PhotoIndex> seen;
  const auto pixels = [&](const PhotoIndex& photo) -> const std::vector<float>& {
    return sight.scene().photos[size_t(photo.first)][size_t(photo.second)].planes.front()->values;
  };
  for (const PhotoIndex& photo : sight.photos()) {
    const auto& values = pixels(photo);
    const std::string_view bytes(reinterpret_cast<const char*>(values.data()),
                                 values.size() * sizeof(float));
    const auto [other, fresh] = seen.emplace(std::hash<std::string_view>()(bytes), photo);
    if (fresh || values != pixels(other->second)) continue;
    warnings.say(
        sight.spec(photo).place,
        fmt::format("photo {} has the very pixels of photo {}", sight.told(photo),
                    sight.told(other->second)),
        "no two photos are equal, not even of a body that stands still: hand over the photo "
        "of this state and camera");
  }
}

}  // namespace hookeye::inspection
