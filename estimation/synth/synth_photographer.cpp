#include "estimation/synth/synth_photographer.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <system_error>

#include "core/input_error.h"
#include "core/text_file.h"
#include "render/vertex_normals.h"

namespace hookeye::detail {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

Json numbers(const Eigen::MatrixXd& values) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < values.cols(); ++j) row.push_back(values(i, j));
    rows.push_back(values.cols() == 1 ? row[0] : row);
  }
  return rows;
}

std::string picture_name(const ExampleSpec& example, size_t photo) {
  return fmt::format("{}-{}.exr", example.name, example.photos[photo].camera);
}

Json photo_json(const ExampleSpec& example, size_t photo, const PhotoState& state) {
  const Camera& camera = state.camera;
  return {{"picture", picture_name(example, photo)},
          {"surface", example.name + ".obj"},
          {"size", {camera.width, camera.height}},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"R", numbers(camera.R)},
          {"t", numbers(camera.t)},
          {"ambient", state.ambient},
          {"sun", numbers(state.sun)},
          {"background", state.background}};
}

void write_stage(const Truth& truth, const fs::path& albedo, const fs::path& stage) {
  const Scene& scene = *truth.model.scene;
  const RenderSurface& surface = scene.body->surface;
  Json out = {{"hookeye_stage", 1}, {"albedo", fs::absolute(albedo).string()}};
  // Of the told surface, as we shade it: those of its cut triangles are others.
  const VertexNormals normals(surface.mesh);
  fs::create_directories(stage);
  for (size_t e = 0; e < truth.states.size(); ++e) {
    const ExampleSpec& example = scene.capture.examples[e];
    SurfaceMesh deformed = surface.mesh;
    deformed.X = surface.deformed(scene.body->mesh, truth.states[e].q);
    write_surface_obj(stage / (example.name + ".obj"), deformed, normals.at(deformed.X));
    for (size_t k = 0; k < example.photos.size(); ++k) {
      const PhotoState& state = truth.model.examples[e].photos[k];
      if (state.specular != 0.0)
        throw InputError({stage.string()}, "another photographer does not know our gloss",
                         "a recipe without `specular`");
      if (!state.uneven.isZero(0.0))
        throw InputError({stage.string()}, "another photographer does not know our harmonics",
                         "a recipe with `ambient` in place of `harmonics`");
      if (state.camera.vignetting != 0.0)
        throw InputError({stage.string()}, "another photographer does not know our vignetting",
                         "a recipe without `vignetting`");
      const CameraModel& model = *state.camera.model;
      if (!state.camera.straight() || !model.central())
        throw InputError(
            {stage.string()},
            fmt::format("another photographer does not know the {} camera {}",
                        state.camera.straight() ? model.name() : "bent", state.camera.name),
            "a recipe with `projection: perspective` and without `distortion`");
      out["photos"].push_back(photo_json(example, k, state));
    }
  }
  write_text(stage / "scene.json", out.dump(1) + "\n");
}

std::string shell_quoted(const std::string& path) {
  std::string out = "'";
  for (const char c : path) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// Blender writes grey as three equal channels.
Image grey(const Image& picture) {
  Image out{picture.width, picture.height, 1, {}};
  out.values.reserve(picture.values.size() / picture.channels);
  for (size_t i = 0; i < picture.values.size(); i += picture.channels)
    out.values.push_back(picture.values[i]);
  return out;
}

Image sensor(Image radiance, const PhotoState& state) {
  cv::Mat pixels(radiance.height, radiance.width, CV_32F, radiance.values.data());
  if (state.blur_variance > 0.0)
    cv::GaussianBlur(pixels, pixels, {0, 0}, std::sqrt(state.blur_variance));
  pixels *= state.gain;
  return radiance;
}

}  // namespace

namespace {

/// std::system(), but that the command hears Ctrl-C, which this program's threads block.
int run_in_shell(const std::string& command) {
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  posix_spawnattr_setsigmask(&attributes, &none);
  std::string shell = "sh", option = "-c", text = command;
  char* const words[] = {shell.data(), option.data(), text.data(), nullptr};
  pid_t child = 0;
  const int error = posix_spawn(&child, "/bin/sh", nullptr, &attributes, words, environ);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) throw std::system_error(error, std::generic_category(), "/bin/sh");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

Pictures photographed_by(const std::string& command, const Truth& truth, const fs::path& albedo,
                         const fs::path& stage) {
  write_stage(truth, albedo, stage);
  const int status = run_in_shell(fmt::format("{} {} 1>&2", command, shell_quoted(stage)));
  if (status != 0)
    throw InputError({command},
                     fmt::format("the photographer ended with exit status {}",
                                 WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status)),
                     "see what it printed above; it is run as `COMMAND FOLDER`");
  const Scene& scene = *truth.model.scene;
  Pictures pictures;
  for (size_t e = 0; e < truth.states.size(); ++e) {
    const ExampleSpec& example = scene.capture.examples[e];
    std::vector<Image> photos;
    for (size_t k = 0; k < example.photos.size(); ++k) {
      const PhotoState& state = truth.model.examples[e].photos[k];
      const fs::path file = stage / picture_name(example, k);
      const Image picture = read_image(file);
      if (picture.width != state.camera.width || picture.height != state.camera.height)
        throw InputError({file.string()},
                         fmt::format("is {} x {} px", picture.width, picture.height),
                         fmt::format("{} x {} px", state.camera.width, state.camera.height));
      photos.push_back(sensor(grey(picture), state));
    }
    pictures.push_back(std::move(photos));
  }
  return pictures;
}

}  // namespace hookeye::detail
