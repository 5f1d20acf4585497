#include "runs/bench.h"

#include "core/json_file.h"
#include "estimation/diagnosis/diagnosis_json.h"
#include "estimation/effects/catalogue.h"
#include "estimation/fit/over_all_pixels.h"
#include "estimation/model/doubts.h"
#include "estimation/output/pixels_json.h"
#include "runs/failed.h"

namespace hookeye {
namespace {

/// Photos whose noise was estimated where it hardly can be.
void warn_of_noise(const Scene& scene, const Warn& warn) {
  std::string first;
  int others = -1;
  for (size_t e = 0; e < scene.photos.size(); ++e)
    for (const Photo& photo : scene.photos[e]) {
      if (!photo.noise.doubtful || others++ >= 0) continue;
      first = fmt::format("example {}, photo {}: noise estimated as {:.2g} at half of full scale",
                          scene.capture.examples[e].name, photo.camera, photo.noise.sigma(0.5));
    }
  if (others < 0) return;
  warn(fmt::format(
      "{}{}, but a small, finely textured or JPEG photo hardly tells it: give it as `noise:`, else "
      "chi and what is found missing may be wrong",
      first, others > 0 ? fmt::format(" (and that of {} more)", others) : ""));
}

/// What is read of run.json beyond what Run itself needs.
nlohmann::json timeline_shape() {
  using nlohmann::json;
  const json some = "number|null", texts = json::array({"text"});
  const json refit = {{"effect", "text"}, {"?chi_fit", some}, {"?chi_validate", some}};
  json rival = refit, raced = refit, score = {{"effect", "text"}, {"?evidence", some}};
  rival["score"] = rival["chi_fit"] = "number";
  raced["?floor"] = some;
  score["?confusion"] = json::array({{{"effect", "text"}, {"?cosine", some}}});
  const json step = {{"added", "text|null"},
                     {"?dropped", texts},
                     {"?not_compared", texts},
                     {"effects", texts},
                     {"chi_fit", "number"},
                     {"?chi_validate", some},
                     {"?rms_px_fit", some},
                     {"?converged", "flag"},
                     {"?iterations", "number"},
                     {"?says", texts},
                     {"?command", "text"},
                     {"?diagnosis", json::array({score})},
                     {"?raced", json::array({raced})},
                     {"?rivals", json::array({rival})}};
  return {{"steps", json::array({step})}, {"?floor", {{"chi", "number"}, {"source", "text"}}}};
}

Run with_whole_timeline(Run run) {
  expect_shape(run.timeline(), timeline_shape(), run.folder() / "run.json");
  return run;
}

}  // namespace

Run open_run(const std::filesystem::path& folder, bool write) {
  return with_whole_timeline(Run::open(folder, write));
}

Run create_run(const std::filesystem::path& folder, const std::filesystem::path& capture) {
  return with_whole_timeline(Run::create(folder, capture));
}

void warn_of_doubts(const Scene& scene, const Warn& warn) {
  for (const auto& said : scene.body->said) warn(said);
  for (const auto& said : doubts(scene)) warn(said);
  warn_of_noise(scene, warn);
}

Bench open_capture(const std::filesystem::path& path, const Warn& warn, const Limits& limits) {
  return bench_of(read_capture(path), warn, limits);
}

Bench bench_of(const Capture& capture, const Warn& warn, const Limits& limits) {
  auto scene = load_scene(without_tests(capture), true, limits);
  for (const auto& [camera, reading] : scene->readings) warn(described(camera, reading));
  warn_of_doubts(*scene, warn);
  return {capture, scene, Workspace(scene)};
}

Step newest_step(const Run& run, Bench& bench, const FitOptions& options) {
  const size_t steps = run.steps().size();
  if (steps == 0)
    throw InputError({run.folder().string()}, "the run has no finished step",
                     "run 'hookeye fit CAPTURE -o RUN' first");
  return step_of(run, bench, steps - 1, options);
}

Step step_of(const Run& run, Bench& bench, size_t index, const FitOptions& options) {
  const auto& entry = run.timeline().at("steps").at(index);
  Step step;
  step.name = entry.at("name");
  if (!entry.at("added").is_null()) step.added = entry.at("added");
  auto [form, p] = read_model(run.steps().at(index) / "model.yaml", bench.scene, catalogue());
  step.fitted = value_or_fail(assess(bench.workspace, form, p, options));
  step.fitted.converged = entry.value("converged", true);
  step.fitted.iterations = entry.value("iterations", 0);
  if (auto known = all_pixels_in(entry.value("all_pixels", nlohmann::json()), form.parameters()))
    take_all_pixels(std::move(*known), &step.fitted);
  return step;
}

std::optional<Diagnosis> stored_diagnosis(const Run& run, const Fitted& newest) {
  const auto file = run.steps().back() / "diagnosis.json";
  if (!std::filesystem::exists(file)) return {};
  try {
    return diagnosis_from_json(read_json(file), newest.form.realise(newest.p), file);
  } catch (const InputError&) {
    return {};  // of another model or version, or damaged: it is made anew
  }
}

}  // namespace hookeye
