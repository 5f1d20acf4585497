#include "runs/look.h"

#include <algorithm>
#include <utility>

namespace hookeye {

void look_with_all_cameras(Capture& capture) {
  for (auto& example : capture.examples)
    for (const auto& camera : capture.cameras) {
      const bool has = std::any_of(example.photos.begin(), example.photos.end(),
                                   [&](const PhotoSpec& p) { return p.camera == camera.name; });
      if (has) continue;
      PhotoSpec photo;
      photo.camera = camera.name;
      photo.place = example.place;
      example.photos.push_back(photo);
    }
}

Sighting look(PhotoComparer& comparer, const Model& model, int e, int k, const VectorXd& q,
              const VectorXd* q_reference) {
  const Scene& scene = *model.scene;
  RenderOptions options = render_options(scene);
  options.derivatives = false;
  const bool rgb = scene.capture.examples[e].photos[k].rgb && scene.albedo.size() > 1;
  const int channels = rgb ? static_cast<int>(scene.albedo.size()) : 1;
  Sighting out;
  Image& all = out.picture;
  for (int c = 0; c < channels; ++c) {
    Rendering rendering = comparer.render(model, q, q_reference, k, c, options);
    const Image& plane = rendering.I;
    if (c == 0) {
      all = {plane.width, plane.height, channels, {}};
      all.values.resize(plane.pixels() * channels);
      out.coverage = std::move(rendering.coverage);
    }
    for (size_t i = 0; i < plane.pixels(); ++i) all.values[i * channels + c] = plane.values[i];
  }
  return out;
}

}  // namespace hookeye
