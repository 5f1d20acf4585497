#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "estimation/model/field_points.h"
#include "estimation/model/model.h"
#include "estimation/model/photo_pyramid.h"

namespace hookeye {

namespace {

/// Splits an albedo picture into linear planes that match how the photos are compared.
std::vector<std::vector<std::shared_ptr<const Image>>> albedo_planes(const BodySpec& body,
                                                                     bool rgb) {
  const Image image = read_image(body.texture_image, body.texture_encoding);
  std::vector<Image> planes;
  if (!rgb || image.channels == 1) {
    planes.push_back(luminance(image));
  } else {
    for (int c = 0; c < image.channels; ++c) {
      Image plane{image.width, image.height, 1, {}};
      plane.values.resize(image.pixels());
      for (size_t i = 0; i < image.pixels(); ++i)
        plane.values[i] = image.values[i * image.channels + c];
      planes.push_back(std::move(plane));
    }
  }
  std::vector<std::vector<std::shared_ptr<const Image>>> pyramids;
  for (auto& plane : planes) {
    std::vector<std::shared_ptr<const Image>> sizes;
    sizes.push_back(std::make_shared<Image>(std::move(plane)));
    while (sizes.size() < 3 && std::min(sizes.back()->width, sizes.back()->height) >= 8)
      sizes.push_back(std::make_shared<Image>(halved(*sizes.back())));
    pyramids.push_back(std::move(sizes));
  }
  return pyramids;
}

bool any_rgb(const Capture& capture) {
  for (const auto& example : capture.examples)
    for (const auto& photo : example.photos)
      if (photo.rgb) return true;
  return false;
}

/// Fits begin with photos of a 32nd of the size, which must have a pixel.
void check_large_enough(const PhotoSpec& spec, const Camera& camera) {
  constexpr int kLeast = 32;
  if (std::min(camera.width, camera.height) >= kLeast) return;
  throw InputError(
      spec.place,
      fmt::format("the photo of camera `{}` has {} x {} pixels, too few for a fit", camera.name,
                  camera.width, camera.height),
      fmt::format("at least {0} x {0} pixels, and the body a hundred pixels across or more",
                  kLeast));
}

std::vector<Photo> photos_of(const ExampleSpec& example, const Capture& capture) {
  std::vector<Photo> out;
  for (const PhotoSpec& spec : example.photos) {
    check_large_enough(spec, capture.camera(spec.camera));
    out.push_back(read_photo(spec, capture.camera(spec.camera)));
  }
  return out;
}

}  // namespace

int Scene::example_index(const std::string& name) const {
  for (size_t i = 0; i < capture.examples.size(); ++i)
    if (capture.examples[i].name == name) return static_cast<int>(i);
  return -1;
}

bool is_rest(const ExampleSpec& example) {
  if (!example.loads.empty()) return false;
  // Held by one jaw alone a body moves as a whole, wherever the jaw goes.
  if (example.supports.size() == 1 &&
      example.supports.front().kind != SupportSpec::Kind::components)
    return true;
  for (const auto& support : example.supports) {
    if (support.kind != SupportSpec::Kind::components) return false;
    for (const auto& u : support.displacement)
      if (u && *u != 0.0) return false;
  }
  return true;
}

std::shared_ptr<const Scene> load_scene(const Capture& capture, bool with_photos,
                                        const Limits& limits) {
  auto scene = std::make_shared<Scene>();
  scene->capture = capture;
  scene->limits = std::make_shared<const Limits>(limits);
  scene->body = std::make_shared<const Body>(make_body(capture));
  scene->photos.resize(capture.examples.size());
  if (capture.body.texture == BodySpec::Texture::image)
    scene->albedo = albedo_planes(capture.body, any_rgb(capture));
  for (const ExampleSpec& example : capture.examples) check_fields(*scene, example);
  if (!with_photos) return scene;
  for (size_t e = 0; e < capture.examples.size(); ++e)
    scene->photos[e] = photos_of(capture.examples[e], capture);
  return scene;
}

Capture without_tests(Capture capture) {
  std::erase_if(capture.examples, [](const ExampleSpec& example) { return example.test; });
  return capture;
}

std::shared_ptr<const Scene> with_tests(const Scene& scene, const Capture& whole) {
  auto out = std::make_shared<Scene>(scene);
  for (const ExampleSpec& example : whole.examples) {
    if (!example.test) continue;
    out->capture.examples.push_back(example);
    check_fields(*out, example);
    out->photos.push_back(photos_of(example, whole));
  }
  return out;
}

std::shared_ptr<const Scene> remeshed(const Scene& scene, double edge_factor, int order,
                                      bool with_photos) {
  auto out = std::make_shared<Scene>();
  out->capture = scene.capture;
  out->limits = scene.limits;
  out->photos.resize(scene.capture.examples.size());
  out->body = std::make_shared<const Body>(remesh(scene.capture, *scene.body, edge_factor, order));
  if (!with_photos) return out;
  out->photos = scene.photos;
  out->albedo = scene.albedo;
  return out;
}

}  // namespace hookeye
