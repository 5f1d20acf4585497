#include "estimation/synth/synth.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/input_error.h"
#include "core/scope.h"
#include "core/text_file.h"
#include "estimation/evaluation/photo_evaluation.h"
#include "estimation/synth/synth_body.h"
#include "estimation/synth/synth_capture.h"
#include "estimation/synth/synth_photographer.h"
#include "estimation/synth/synth_truth.h"

namespace hookeye {

namespace fs = std::filesystem;
using detail::GripForce;
using detail::SynthBody;
using Json = nlohmann::ordered_json;

fs::path truth_file(const fs::path& capture) {
  fs::path folder = fs::absolute(capture).lexically_normal();
  if (folder.filename().empty()) folder = folder.parent_path();
  folder += ".truth.json";
  return folder;
}

namespace {

/// A folder that goes away unless it is kept, and one beside it that always goes.
class Staging {
 public:
  explicit Staging(const fs::path& out)
      : folder_(out.parent_path() /
                fmt::format(".{}.partial-{}", out.filename().string(), ::getpid())),
        stage_(folder_.string() + ".stage") {
    fs::create_directories(folder_ / "photos");
  }
  ~Staging() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
    fs::remove_all(stage_, ignored);
  }
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;
  const fs::path& folder() const { return folder_; }
  /// For another photographer; not there until it is written to.
  const fs::path& stage() const { return stage_; }
  void become(const fs::path& out) { fs::rename(folder_, out); }

 private:
  fs::path folder_, stage_;
};

/// Normal deviates by Box and Muller: the same with every standard library.
class Normal {
 public:
  explicit Normal(std::mt19937_64 random) : random_(std::move(random)) {}
  double operator()() {
    const double u = 1.0 - detail::uniform(random_, 0.0, 1.0);
    return std::sqrt(-2.0 * std::log(u)) *
           std::cos(2.0 * std::numbers::pi * detail::uniform(random_, 0.0, 1.0));
  }

 private:
  std::mt19937_64 random_;
};

void write_triangles(const fs::path& file, const std::vector<int>& triangles) {
  std::string text;
  for (size_t i = 0; i < triangles.size(); ++i)
    text += fmt::format("{}{}", triangles[i], i % 16 == 15 ? "\n" : " ");
  write_text(file, text + "\n");
}

/// The capture with its true material, all cameras looking at all examples, without pixels.
Capture true_capture(const Recipe& recipe, const SynthBody& body, const fs::path& folder) {
  write_text(folder / "capture.yaml", detail::capture_text(recipe, body, {.truth = true}));
  Capture capture = read_capture(folder);
  capture.body.order = recipe.truth.order;
  for (auto& example : capture.examples)
    for (const Camera& camera : capture.cameras) {
      PhotoSpec photo;
      photo.camera = camera.name;
      photo.place = example.place;
      if (recipe.photos.silhouette) photo.kind = PhotoSpec::Kind::silhouette;
      example.photos.push_back(photo);
    }
  return capture;
}

/// Refuses a rig that cuts the body off in some picture.
void check_in_view(const Recipe& recipe, const detail::Truth& truth) {
  const Scene& scene = *truth.model.scene;
  for (size_t e = 0; e < truth.states.size(); ++e) {
    const Matrix3Xd x = scene.body->surface.deformed(scene.body->mesh, truth.states[e].q);
    for (const PhotoState& photo : truth.model.examples[e].photos) {
      double beyond = -1e300;
      for (Eigen::Index v = 0; v < x.cols(); ++v) {
        const Eigen::Vector2d px = photo.camera.project(x.col(v));
        if (!px.allFinite())
          throw InputError(recipe.cameras.place,
                           fmt::format("in example {} a part of the body lies behind {}, or past "
                                       "its lens",
                                       scene.capture.examples[e].name, photo.camera.name),
                           "a longer distance or another look_at");
        beyond = std::max({beyond, -px.x(), -px.y(), px.x() - (photo.camera.width - 1),
                           px.y() - (photo.camera.height - 1)});
      }
      if (!(beyond < 0.0))
        throw InputError(recipe.cameras.place,
                         fmt::format("in example {} the body leaves the picture of {} by {:.0f} px",
                                     scene.capture.examples[e].name, photo.camera.name, beyond),
                         "a shorter focal length, a longer distance or another look_at");
    }
  }
}

/// Photons as a normal deviate of their variance, read noise on top.
void add_noise(const NoiseRecipe& noise, Normal normal, Image& image) {
  for (float& value : image.values) {
    const double photons = noise.full_well > 0.0 ? std::max(0.0f, value) / noise.full_well : 0.0;
    value = static_cast<float>(value + std::sqrt(photons) * normal() + noise.read * normal());
  }
}

/// White where the body covers more than `threshold` of a pixel.
void cut_out(double threshold, Image& image) {
  for (float& value : image.values) value = value > threshold ? 1.0f : 0.0f;
}

detail::Pictures our_pictures(const Recipe& recipe, const detail::Truth& truth,
                              const SynthOptions& options) {
  const auto scene = truth.model.scene;
  RenderOptions render = render_options(*scene);
  render.derivatives = false;
  render.rays_per_axis = recipe.truth.rays_per_axis;
  render.visibility_rays = recipe.truth.visibility_rays;
  detail::Pictures pictures(truth.states.size());
  tbb::parallel_for(size_t{0}, truth.states.size(), [&](size_t e) {
    const ExampleSpec& example = scene->capture.examples[e];
    const Scope scope("example " + example.name);
    PhotoComparer comparer(scene, static_cast<int>(e));
    for (size_t k = 0; k < example.photos.size(); ++k) {
      if (options.cancel && *options.cancel) return;
      if (options.progress)
        options.progress(fmt::format("{} by {}", example.name, example.photos[k].camera));
      pictures[e].push_back(
          comparer.render(truth.model, truth.states[e].q, nullptr, static_cast<int>(k), 0, render)
              .I);
    }
  });
  return pictures;
}

void write_photos(const Recipe& recipe, const detail::Truth& truth, detail::Pictures pictures,
                  const fs::path& folder) {
  for (size_t e = 0; e < pictures.size(); ++e) {
    const ExampleSpec& example = truth.model.scene->capture.examples[e];
    for (size_t k = 0; k < pictures[e].size(); ++k) {
      const std::string& camera = example.photos[k].camera;
      const std::string purpose = fmt::format("photo {} {}", example.name, camera);
      add_noise(recipe.noise, Normal(detail::random_of(recipe.seed, purpose)), pictures[e][k]);
      if (recipe.photos.silhouette) cut_out(*recipe.photos.silhouette, pictures[e][k]);
      write_image(folder / detail::photo_name(recipe, example.name, camera), pictures[e][k]);
    }
  }
}

std::vector<GripForce> measured_forces(const Recipe& recipe, const SynthBody& body,
                                       const detail::Truth& truth) {
  std::vector<GripForce> measured;
  for (size_t e = 0; e < truth.states.size(); ++e) {
    Normal normal(detail::random_of(recipe.seed, "forces " + recipe.examples[e].name));
    GripForce grip = truth.states[e].grip;
    if (recipe.examples[e].moves()) {
      const double unit = detail::force_unit(recipe, body, recipe.examples[e]);
      for (int i = 0; i < 3; ++i) grip.force[i] += recipe.noise.force * unit * normal();
      for (int i = 0; i < 3; ++i)
        grip.moment[i] += recipe.noise.moment * unit * recipe.shape.height() * normal();
    }
    measured.push_back(grip);
  }
  return measured;
}

/// Nine digits: further ones depend on where arrays happen to lie in memory (sums are vectorised),
/// and the same seed must give the same file.
double to_nine_digits(double value) { return std::stod(fmt::format("{:.9g}", value)); }

Json vector_json(const Vector3d& v) {
  return {to_nine_digits(v.x()), to_nine_digits(v.y()), to_nine_digits(v.z())};
}

Json truth_json(const Recipe& recipe, const detail::Truth& truth) {
  const Scene& scene = *truth.model.scene;
  Json out = {{"hookeye_truth", 1}, {"title", recipe.title}, {"seed", recipe.seed}};
  for (const auto& [name, value] : recipe.material.truth.parameters)
    out["material"][name] = value.numbers;
  out["hidden"] = Json::array();
  for (const detail::PutIn& put : truth.hidden) {
    Json values = Json::object();
    const auto parameters = put.ingredient->parameters();
    for (size_t i = 0; i < parameters.size(); ++i)
      values[parameters[i].name] = to_nine_digits(put.values[i]);
    out["hidden"].push_back({{"effect", put.effect->name()},
                             {"variant", put.ingredient->variant()},
                             {"values", values},
                             {"rms_px", to_nine_digits(put.rms_px)},
                             {"sentence", put.sentence}});
  }
  out["mesh"] = {{"nodes", scene.body->mesh.nodes()},
                 {"elements", scene.body->mesh.size()},
                 {"order", scene.body->mesh.order},
                 {"elements_lost", truth.elements_lost}};
  for (size_t e = 0; e < truth.states.size(); ++e)
    if (recipe.examples[e].moves())
      out["measured"][recipe.examples[e].name] = {
          {"force", vector_json(truth.states[e].grip.force)},
          {"moment", vector_json(truth.states[e].grip.moment)}};
  out["recipe"] = recipe.text;
  return out;
}

/// What a capture needs before any example is solved.
SynthBody write_body(const Recipe& recipe, const fs::path& folder) {
  SynthBody body = detail::make_synth_body(recipe);
  write_surface_obj(folder / "surface.obj", body.surface);
  if (!recipe.photos.silhouette) write_image(folder / "albedo.png", body.albedo);
  for (const RegionSpec& region : body.regions)
    if (const auto* faces = std::get_if<RegionSpec::Faces>(&region.shape))
      write_triangles(folder / detail::faces_file(region), faces->triangles);
  return body;
}

}  // namespace

Result<Synthesis> synthesize(const Recipe& recipe, const fs::path& given,
                             const SynthOptions& options) {
  fs::path out = fs::absolute(given).lexically_normal();
  if (out.filename().empty()) out = out.parent_path();
  if (fs::exists(out))
    throw InputError({given.string()}, "this folder is there already",
                     "name a new one, or remove it first");
  if (recipe.photos.silhouette && !options.photographer.empty())
    throw InputError(recipe.photos.place, "another photographer takes no silhouettes",
                     "a recipe without `kind: silhouette`");
  Staging staging(out);
  const fs::path& folder = staging.folder();
  const SynthBody body = write_body(recipe, folder);
  if (options.progress) options.progress("equilibrium of every example");
  const auto told = load_scene(true_capture(recipe, body, folder), false);
  const auto scene = remeshed(*told, recipe.truth.edge_factor, 0, true);
  auto found = detail::find_truth(recipe, scene, options.cancel);
  if (!found) return failure_of(found);
  const auto& truth = *found;
  check_in_view(recipe, truth);
  auto pictures = options.photographer.empty()
                      ? our_pictures(recipe, truth, options)
                      : detail::photographed_by(options.photographer, truth, folder / "albedo.png",
                                                staging.stage());
  if (options.cancel && *options.cancel) return stopped();
  write_photos(recipe, truth, std::move(pictures), folder);
  write_text(folder / "capture.yaml",
             detail::capture_text(
                 recipe, body, {.photos = true, .measured = measured_forces(recipe, body, truth)}));
  read_capture(folder);
  Synthesis result{out, truth_file(out), scene->body->mesh.nodes(), 0, {}};
  for (const auto& example : scene->capture.examples)
    result.photos += static_cast<int>(example.photos.size());
  for (const auto& put : truth.hidden)
    result.hidden.push_back({put.effect->name(), put.sentence, put.rms_px});
  write_text(result.truth, truth_json(recipe, truth).dump(1) + "\n");
  staging.become(out);
  return result;
}

}  // namespace hookeye
