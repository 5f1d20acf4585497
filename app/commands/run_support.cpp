#include "app/commands/run_support.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "app/commands/tables.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/report/answer.h"
#include "app/report/decision_log.h"
#include "capture_io/json_file.h"
#include "estimation/diagnosis/diagnosis_json.h"
#include "estimation/effects/catalogue.h"
#include "estimation/fit/at_floor.h"
#include "estimation/model/doubts.h"
#include "estimation/output/page_data.h"
#include "estimation/output/removed.h"
#include "estimation/output/step_json.h"
#include "estimation/search/contest.h"

namespace hookeye {
namespace {

/// Photos whose noise was estimated where it hardly can be.
void warn_of_noise(const Scene& scene, Session& session) {
  std::string first;
  int others = -1;
  for (size_t e = 0; e < scene.photos.size(); ++e)
    for (const Photo& photo : scene.photos[e]) {
      if (!photo.noise.doubtful || others++ >= 0) continue;
      first = fmt::format("example {}, photo {}: noise estimated as {:.2g} at half of full scale",
                          scene.capture.examples[e].name, photo.camera, photo.noise.sigma(0.5));
    }
  if (others < 0) return;
  session.warn(fmt::format(
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

void warn_of_doubts(const Scene& scene, Session& session) {
  for (const auto& said : scene.body->said) session.warn(said);
  for (const auto& said : doubts(scene)) session.warn(said);
  warn_of_noise(scene, session);
}

Bench open_capture(const std::filesystem::path& capture_path, Session& session,
                   const Limits& limits) {
  const Capture capture = read_capture(capture_path);
  auto scene = load_scene(without_tests(capture), true, limits);
  warn_of_doubts(*scene, session);
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

FitOptions fit_options() {
  FitOptions options;
  options.cancel = &interrupted();
  auto progress = std::make_shared<Progress>("fit", 0);
  options.progress = [progress](const FitProgress& now) {
    progress->set(now.iteration, now.of,
                  now.chi > 0.0 ? fmt::format("{}, misfit {:.3f}", now.stage, now.chi) : now.stage);
  };
  return options;
}

DiagnosisOptions diagnosis_options() {
  DiagnosisOptions options;
  options.cancel = &interrupted();
  auto progress = std::make_shared<Progress>("diagnose", 0);
  options.progress = [progress](int done, int of) {
    progress->set(done, of, "loads solved and compared");
  };
  return options;
}

std::string not_converged(bool converged, int iterations) {
  if (converged) return {};
  return fmt::format(
      "the fit has not converged: the misfit still fell when it stopped after {} iterations, "
      "so that its values may move further",
      iterations);
}

std::vector<std::string> tied_in(const nlohmann::json& step, const Limits& limits) {
  std::vector<std::string> tied;
  for (const auto& rival : step.value("rivals", nlohmann::json::array()))
    if (rival.at("score").get<double>() > -limits.diagnosis.tie) tied.push_back(rival.at("effect"));
  return tied;
}

Contested contested_in(const nlohmann::json& step) {
  Contested out;
  if (!step.at("added").is_null()) out.added = step.at("added");
  out.dropped = step.value("dropped", std::vector<std::string>());
  out.not_compared = step.value("not_compared", std::vector<std::string>());
  for (const auto& rival : step.value("rivals", nlohmann::json::array()))
    out.rivals.push_back({rival.at("effect"), rival.at("score"), rival.at("chi_fit"), 0.0});
  out.chi_fit = number_in(step, "chi_fit");
  out.chi_validate = number_in(step, "chi_validate");
  out.measured_r2 = number_in(step, "measured_r2");
  return out;
}

DiscoverOptions discover_options() {
  DiscoverOptions options;
  options.fit = fit_options();
  options.diagnosis = diagnosis_options();
  return options;
}

void tell_floor(nlohmann::json& timeline, const Floor& floor) {
  const nlohmann::json told = timeline.value("floor", nlohmann::json::object());
  if (told.value("source", "") == floor.source && told.value("chi", HUGE_VAL) <= floor.chi) return;
  timeline["floor"] = to_json(floor);
  timeline["floor"].erase("moved_at_rest");  // of one model, not of the photos
}

namespace {

/// What discover said was said of the step that was the newest then. Before the new step is
/// written, so that no kill leaves it beside a step that it does not mean.
void drop_verdict(Run& run, bool of_search) {
  run.update([&](nlohmann::json& timeline) {
    for (const char* key :
         {"verdict", "sentence", "missing", "tie", "untold", "hint", "fitted_to_all", "tested"})
      timeline.erase(key);
    if (!of_search) timeline.erase("search");
  });
}

}  // namespace

std::filesystem::path record(Run& run, const Step& step, const std::string& command,
                             bool of_search) {
  nlohmann::json entry = timeline_entry(step);
  entry["command"] = command;
  std::error_code gone;  // a folder that was removed meanwhile has no name
  entry["made_in"] = std::filesystem::current_path(gone).string();
  entry["made_by"] = versions();
  drop_verdict(run, of_search);
  return run.add_step(step.name, std::move(entry), [&](const std::filesystem::path& folder) {
    write_step(folder, *step.fitted.form.scene, step);
  });
}

Step with_displaced(Bench& bench, Step step, const std::atomic<bool>* cancel) {
  if (lacks_displaced(step.diagnosis))
    if (auto failure = displace_again(bench.workspace, step.fitted, cancel, step.diagnosis))
      fail(std::move(*failure));
  return step;
}

void record_diagnosis(Run& run, const Step& step) {
  const auto folder = run.steps().back();
  run.add_file(
      folder, "diagnosis.json",
      [&](const std::filesystem::path& file) {
        write_text(file, diagnosis_json(step).dump(1) + "\n");
      },
      true);
  if (has_pictures(step.diagnosis))
    run.add_file(
        folder, "removed",
        [&](const std::filesystem::path& pictures) { write_removed(pictures, step); }, true);
  run.update([&](nlohmann::json& timeline) {
    const auto entry = timeline_entry(step);
    timeline["steps"].back()["diagnosis"] = entry["diagnosis"];
    timeline["steps"].back()["parameters"] = entry["parameters"];
    if (entry.contains("gate")) timeline["steps"].back()["gate"] = entry["gate"];
    tell_floor(timeline, step.diagnosis.floor);
  });
}

void diagnose_newest(Run& run, Bench& bench, Step& step, const DiagnosisOptions& options) {
  step.diagnosis = value_or_fail(diagnose(bench.workspace, step.fitted, options));
  reach_for_mesh(step.fitted, step.diagnosis);
  step = with_displaced(bench, std::move(step), options.cancel);
  record_diagnosis(run, step);
  log_naming(run, step.diagnosis);
}

void tell_free_form(const Run& run, Bench& bench, const Step& step, Session& session) {
  constexpr size_t kTold = 3;
  const std::filesystem::path folder = run.steps().back();
  for (const char* stale : {"free_form.json", "free_form.vtu", "page/free_form.json"})
    std::filesystem::remove(folder / stale);
  if (at_floor(step.fitted, step.diagnosis.floor)) return;
  auto fields = value_or_fail(free_form(bench.workspace, step.fitted, &interrupted()));
  if (fields.empty()) return;
  session.document["free_form"] = to_json(fields);
  write_text(folder / "free_form.json", session.document["free_form"].dump(1) + "\n");
  fields.resize(std::min(fields.size(), kTold));
  write_free_form(folder / "free_form.vtu", *step.fitted.form.scene, fields);
  write_page_free_form(folder / "page", *step.fitted.form.scene, fields);
  session.say("{}", wrapped("no effect of the catalogue explains what is left. Forces that would "
                            "show where to look, whatever they stand for:"));
  for (const FreeForm& field : fields) session.say("{}", wrapped("- " + field.sentence));
  session.say("for ParaView: {}\n", (folder / "free_form.vtu").string());
}

void say_answer(const Run& run, Session& session) {
  const nlohmann::json answer = answer_of(run.folder(), run.timeline());
  session.document["answer"] = answer;
  session.say("{}", answer_text(answer));
}

void say_pictures(const std::filesystem::path& step, const Session& session) {
  const auto compared = step / "compare";  // removed by hand, or of forces and positions alone
  if (!std::filesystem::exists(compared) || std::filesystem::is_empty(compared)) return;
  session.say("pictures: {}\n", compared.string());
  if (std::filesystem::exists(step / "removed"))
    session.say("          what effects would remove:\n          {}\n",
                (step / "removed").string());
}

}  // namespace hookeye
