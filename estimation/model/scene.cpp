#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <mutex>
#include <set>

#include "capture_io/photo_reader.h"
#include "core/freed_memory.h"
#include "core/memory_left.h"
#include "core/work_clock.h"
#include "estimation/model/field_points.h"
#include "estimation/model/gauges.h"
#include "estimation/model/model.h"
#include "estimation/model/photo_pyramid.h"
#include "estimation/model/session_sensors.h"

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

/// One photo of the capture.
struct Wanted {
  const ExampleSpec* example;
  const PhotoSpec* spec;
};

std::vector<Wanted> wanted_photos(const Capture& capture) {
  std::vector<Wanted> out;
  for (const ExampleSpec& example : capture.examples)
    for (const PhotoSpec& spec : example.photos) out.push_back({&example, &spec});
  return out;
}

/// The photo of each camera that tells how all of its are read: of pictures rather than silhouettes
/// the first by the file's name, whatever the order of the capture.
std::map<std::string, const PhotoSpec*> deciding_photos(const std::vector<Wanted>& all) {
  const auto rank = [](const PhotoSpec& spec) {
    return std::make_pair(spec.kind == PhotoSpec::Kind::silhouette, spec.file);
  };
  std::map<std::string, const PhotoSpec*> out;
  for (const Wanted& one : all) {
    const PhotoSpec*& first = out[one.spec->camera];
    if (!first || rank(*one.spec) < rank(*first)) first = one.spec;
  }
  return out;
}

/// What several photos of a camera have alike, in one copy: which pixels count (all, or those of a
/// mask), and what is behind the body. Any thread.
class HeldOnce {
 public:
  void share(Photo* photo) {
    const std::lock_guard lock(mutex_);
    Kept& kept = kept_[photo->camera];
    one_of(&kept.valid, &photo->valid);
    kept.backdrop.resize(std::max(kept.backdrop.size(), photo->backdrop.size()));
    for (size_t k = 0; k < photo->backdrop.size(); ++k)
      one_of(&kept.backdrop[k], &photo->backdrop[k]);
  }

 private:
  struct Kept {
    SharedValue<std::vector<unsigned char>> valid;
    std::vector<SharedValue<Image>> backdrop;
  };
  static bool alike(const std::vector<unsigned char>& a, const std::vector<unsigned char>& b) {
    return a == b;
  }
  static bool alike(const Image& a, const Image& b) {
    return a.width == b.width && a.height == b.height && a.values == b.values;
  }
  template <class Value>
  static void one_of(SharedValue<Value>* kept, SharedValue<Value>* own) {
    if (alike(**kept, **own))
      *own = *kept;
    else
      *kept = *own;
  }

  std::mutex mutex_;
  std::map<std::string, Kept> kept_;
};

/// In the order of `all`, a few at a time: a photo of 12 Mpx takes some hundred MB until it is
/// halved. The first of several faults is the one told.
struct ReadAs {
  PhotoReadings readings;
  Weighed weighed = Weighed::yes;
  PhotosRead progress;  ///< may be empty
};
std::vector<Photo> read_all(const std::vector<Wanted>& all, const Capture& capture,
                            const ReadAs& as) {
  constexpr int kAtOnce = 4;
  std::vector<Photo> out(all.size());
  std::vector<std::exception_ptr> faults(all.size());
  std::atomic<bool> failed = false;
  std::atomic<int> done = 0;
  PhotoReader reader;
  HeldOnce held;
  FreedMemoryReturned freed;
  const auto read = [&](size_t i) {
    if (failed) return;
    const Working part(WorkPart::reading);
    try {
      const PhotoSpec& spec = *all[i].spec;
      const Camera& camera = capture.camera(spec.camera);
      check_large_enough(spec, camera);
      const MemoryClaim claim(decoding_bytes(camera));
      out[i] = reader.read(spec, camera, as.weighed);
      const auto reading = as.readings.find(spec.camera);
      if (reading != as.readings.end())
        out[i] =
            as_read(std::move(out[i]), reading->second, all[i].example->name + "/" + spec.camera);
      held.share(&out[i]);
    } catch (...) {
      faults[i] = std::current_exception();
      failed = true;
    }
    freed.after_one();
    if (as.progress) as.progress(++done, static_cast<int>(all.size()));
  };
  tbb::task_arena few(std::min(kAtOnce, tbb::this_task_arena::max_concurrency()));
  few.execute([&] { tbb::parallel_for(size_t{0}, all.size(), read, tbb::simple_partitioner()); });
  for (const auto& fault : faults)
    if (fault) std::rethrow_exception(fault);
  return out;
}

/// Photos in the order of wanted_photos(), by example.
std::vector<std::vector<Photo>> by_example(std::vector<Photo> all, const Capture& capture) {
  std::vector<std::vector<Photo>> out;
  size_t next = 0;
  for (const ExampleSpec& example : capture.examples) {
    out.emplace_back();
    for (size_t k = 0; k < example.photos.size(); ++k) out.back().push_back(std::move(all[next++]));
  }
  return out;
}

/// Photos of the capture's examples, by example.
std::vector<std::vector<Photo>> photos_of(const Capture& capture, const ReadAs& as) {
  return by_example(read_all(wanted_photos(capture), capture, as), capture);
}

/// What of the halved photos of one camera may show the body: where it lies at rest, and where any
/// photo differs from `deciding`. A fitted placement may begin far off.
PhotoWindow window_of(const std::vector<Photo>& photos, size_t deciding, const Camera& camera,
                      int halvings, const Body& body, const Capture& capture) {
  if (capture.body.fit_placement) return {};
  PhotoWindow window = window_of_body(camera, body.surface.mesh, halvings);
  for (const Photo& photo : photos) window = window.with(changed_between(photo, photos[deciding]));
  return with_margin(window, camera.width >> halvings, camera.height >> halvings);
}

/// `photos`: of all cameras.
PhotoReading reading_of_camera(const PhotoSpec& deciding, const Camera& camera, const Body& body,
                               const FitLimits& limits, size_t photos) {
  constexpr double kOfBudget = 0.5;  // the other half: solver, derivatives, pictures
  const MemoryClaim claim(decoding_bytes(camera));
  const Photo photo = read_photo(deciding, camera);
  const SurfaceMesh& surface = body.surface.mesh;
  PhotoReading out = reading_of(photo, camera, surface, limits);
  const int before = out.halvings;
  out = within_memory(out, camera, surface, static_cast<double>(photos),
                      static_cast<double>(photo.planes.size()), kOfBudget * memory_budget());
  if (out.halvings > before && photo.kind == PhotoSpec::Kind::image) {
    const int plane = photo.planes.size() == 3 ? 1 : 0;
    const double all = told_of_motion(photo, plane, 0);
    out.kept = all > 0.0 ? std::min(1.0, told_of_motion(photo, plane, out.halvings) / all) : 0.0;
  }
  return out;
}

/// Reads the photos of large cameras, one camera after the other, and all others as they are.
struct ReadPhotos {
  std::vector<Photo> photos;  ///< in the order of wanted_photos()
  PhotoReadings readings;
};
ReadPhotos read_as_needed(const Capture& capture, const Body& body, const FitLimits& limits) {
  const std::vector<Wanted> all = wanted_photos(capture);
  ReadPhotos out{std::vector<Photo>(all.size()), {}};
  for (const auto& [name, deciding] : deciding_photos(all)) {
    const Camera& camera = capture.camera(name);
    const bool large = limits.pixels > 0.0 && double(camera.width) * camera.height > limits.pixels;
    PhotoReading reading;
    if (large) reading = reading_of_camera(*deciding, camera, body, limits, all.size());
    PhotoReading halved_only;
    halved_only.halvings = reading.halvings;
    std::vector<Wanted> own;
    std::vector<size_t> place;
    size_t first = 0;
    for (size_t i = 0; i < all.size(); ++i) {
      if (all[i].spec->camera != name) continue;
      if (all[i].spec == deciding) first = own.size();
      own.push_back(all[i]), place.push_back(i);
    }
    std::vector<Photo> photos = read_all(own, capture, {{{name, halved_only}}, Weighed::yes, {}});
    if (large) reading.window = window_of(photos, first, camera, reading.halvings, body, capture);
    PhotoReading rest = reading;
    rest.halvings = 0;
    HeldOnce held;
    for (size_t k = 0; k < own.size(); ++k) {
      Photo& photo = out.photos[place[k]];
      photo = as_read(std::move(photos[k]), rest, own[k].example->name + "/" + name);
      held.share(&photo);
    }
    if (!reading.whole()) out.readings[name] = reading;
  }
  return out;
}

}  // namespace

int Scene::example_index(const std::string& name) const {
  for (size_t i = 0; i < capture.examples.size(); ++i)
    if (capture.examples[i].name == name) return static_cast<int>(i);
  return -1;
}

int Scene::halvings_of(const std::string& camera) const {
  const auto reading = readings.find(camera);
  return reading == readings.end() ? 0 : reading->second.halvings;
}

bool Scene::in_part(const std::string& camera) const {
  const auto reading = readings.find(camera);
  return reading != readings.end() && reading->second.in_part();
}

bool Scene::in_part() const {
  return std::any_of(readings.begin(), readings.end(),
                     [](const auto& one) { return one.second.in_part(); });
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

namespace {

/// The body and what stands beside it, without photos.
std::shared_ptr<Scene> bare_scene(const Capture& capture, const Limits& limits) {
  auto scene = std::make_shared<Scene>();
  scene->capture = capture;
  scene->limits = std::make_shared<const Limits>(limits);
  scene->body = std::make_shared<const Body>(make_body(capture));
  scene->photos.resize(capture.examples.size());
  if (capture.body.texture == BodySpec::Texture::image)
    scene->albedo = albedo_planes(capture.body, any_rgb(capture));
  for (const ExampleSpec& example : capture.examples) {
    check_fields(*scene, example);
    check_gauges(*scene, example);
    check_sensors(capture, example);
  }
  return scene;
}

void take_readings(PhotoReadings readings, Scene* scene) {
  scene->readings = std::move(readings);
  for (Camera& camera : scene->capture.cameras)
    if (const auto reading = scene->readings.find(camera.name); reading != scene->readings.end()) {
      reading->second.taken_width = camera.width, reading->second.taken_height = camera.height;
      camera = as_read(camera, reading->second);
    }
}

}  // namespace

std::shared_ptr<const Scene> load_scene(const Capture& capture, bool with_photos,
                                        const Limits& limits) {
  auto scene = bare_scene(capture, limits);
  if (!with_photos) return scene;
  ReadPhotos read = read_as_needed(capture, *scene->body, limits.fit);
  scene->photos = by_example(std::move(read.photos), capture);
  take_readings(std::move(read.readings), scene.get());
  return scene;
}

std::shared_ptr<const Scene> load_scene_to_look_at(const Capture& capture, int longest_px,
                                                   const PhotosRead& progress) {
  auto scene = bare_scene(capture, {});
  PhotoReadings readings;
  for (const Camera& camera : capture.cameras) {
    PhotoReading reading;
    while (std::max(camera.width, camera.height) >> reading.halvings > longest_px)
      ++reading.halvings;
    if (reading.halvings > 0) readings[camera.name] = reading;
  }
  scene->photos = photos_of(capture, {readings, Weighed::no, progress});
  take_readings(std::move(readings), scene.get());
  return scene;
}

Capture without_tests(Capture capture) {
  std::erase_if(capture.examples, [](const ExampleSpec& example) { return example.test; });
  return capture;
}

std::shared_ptr<const Scene> with_tests(const Scene& scene, const Capture& whole) {
  auto out = std::make_shared<Scene>(scene);
  Capture tests = whole;
  std::erase_if(tests.examples, [](const ExampleSpec& example) { return !example.test; });
  for (const ExampleSpec& example : tests.examples) {
    out->capture.examples.push_back(example);
    check_fields(*out, example);
    check_gauges(*out, example);
    check_sensors(tests, example);
  }
  for (auto& photos : photos_of(tests, {scene.readings, Weighed::yes, {}}))
    out->photos.push_back(std::move(photos));
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
  out->readings = scene.readings;
  out->albedo = scene.albedo;
  return out;
}

}  // namespace hookeye
