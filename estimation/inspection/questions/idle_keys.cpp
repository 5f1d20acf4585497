// Is something told that nothing will use?
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "estimation/inspection/question.h"

namespace hookeye::inspection {

namespace {

/// The texture's photos show the body in its light: no other is computed.
void ask_of_light(Sight& sight, Warnings& warnings) {
  const BodySpec& body = sight.scene().capture.body;
  if (body.texture != BodySpec::Texture::rest || !warnings.has({"light"})) return;
  warnings.say(warnings.place({"light"}),
               fmt::format("the light changes nothing: the texture comes from the photos of "
                           "example `{}`, which are lit already",
                           body.texture_example),
               "leave `light` out; it is for textures from an image or of one albedo");
}

/// Unknowns of an example that its supports prescribe, by number.
std::vector<bool> prescribed(const Sight& sight, int e) {
  std::vector<bool> out(static_cast<size_t>(sight.scene().body->mesh.X.size()), false);
  for (const int unknown : sight.model().examples[static_cast<size_t>(e)].loading.prescribed)
    out[static_cast<size_t>(unknown)] = true;
  return out;
}

bool holds_all(const Sight& sight, int e, const Region& region) {
  const std::vector<bool> held = prescribed(sight, e);
  return std::all_of(region.nodes.begin(), region.nodes.end(), [&](int node) {
    const auto first = static_cast<size_t>(3 * node);
    return held[first] && held[first + 1] && held[first + 2];
  });
}

/// What pulls at nodes that are held moves nothing.
void ask_of_loads(Sight& sight, Warnings& warnings) {
  const Scene& scene = sight.scene();
  std::map<std::string, std::pair<Place, std::vector<std::string>>> idle;  // by region: examples
  for (size_t i = 0; i < scene.capture.examples.size(); ++i) {
    const int e = static_cast<int>(i);
    for (const LoadSpec& load : sight.example(e).loads) {
      if (load.region.empty() || !holds_all(sight, e, scene.body->regions.at(load.region)))
        continue;
      sight.doubt_load(e);
      auto& [place, examples] =
          idle.try_emplace(load.region, load.place, std::vector<std::string>()).first->second;
      examples.push_back("`" + sight.example(e).name + "`");
    }
  }
  for (const auto& [region, where] : idle)
    warnings.say(
        where.first,
        fmt::format("the supports of {} {} hold all of region `{}`: its load moves nothing",
                    where.second.size() > 1 ? "examples" : "example", fmt::join(where.second, ", "),
                    region),
        "look at the regions, at the sign of a half-space's normal for example (`check -o "
        "DIR` draws them)");
}

}  // namespace

void ask_idle_keys(Sight& sight, Warnings& warnings) {
  ask_of_light(sight, warnings);
  ask_of_loads(sight, warnings);
}

}  // namespace hookeye::inspection
