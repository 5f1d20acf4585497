#include "app/commands/run_support.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <map>

#include "app/interrupt.h"
#include "app/progress.h"
#include "estimation/removed.h"
#include "estimation/step_json.h"

namespace hookeye {

Bench open_capture(const std::filesystem::path& capture_path, Session& session) {
  const Capture capture = read_capture(capture_path);
  auto scene = load_scene(capture);
  for (const auto& said : scene->body->said) session.warn(said);
  return {scene, Workspace(scene)};
}

Step newest_step(const Run& run, Bench& bench, const FitOptions& options) {
  const auto steps = run.steps();
  if (steps.empty())
    throw InputError({run.folder().string()}, "the run has no finished step",
                     "run 'hookeye fit CAPTURE -o RUN' first");
  const auto& entry = run.timeline().at("steps").back();
  Step step;
  step.name = entry.at("name");
  if (!entry.at("added").is_null()) step.added = entry.at("added");
  auto [form, p] = read_model(steps.back() / "model.yaml", bench.scene);
  step.fitted = value_or_fail(assess(bench.workspace, form, p, options));
  step.fitted.converged = entry.value("converged", true);
  step.fitted.iterations = entry.value("iterations", 0);
  return step;
}

FitOptions fit_options() {
  FitOptions options;
  options.cancel = &interrupted();
  auto progress = std::make_shared<Progress>("fit", 0);
  options.progress = [progress](const FitProgress& now) {
    progress->set(now.iteration, now.of,
                  now.chi > 0.0 ? fmt::format("{}, chi {:.3f}", now.stage, now.chi) : now.stage);
  };
  return options;
}

DiscoverOptions discover_options() {
  DiscoverOptions options;
  options.fit = fit_options();
  options.cancel = options.diagnosis.cancel = options.fit.cancel;
  return options;
}

std::filesystem::path record(Run& run, const Step& step, const std::string& command) {
  nlohmann::json entry = timeline_entry(step);
  entry["command"] = command;
  entry["made_by"] = versions();
  return run.add_step(step.name, std::move(entry), [&](const std::filesystem::path& folder) {
    write_step(folder, *step.fitted.form.scene, step);
  });
}

void record_diagnosis(Run& run, const Step& step) {
  const auto folder = run.steps().back();
  run.add_file(
      folder, "diagnosis.json",
      [&](const std::filesystem::path& file) {
        write_text(file, to_json(step.diagnosis).dump(1) + "\n");
      },
      true);
  run.add_file(
      folder, "parameters.csv",
      [&](const std::filesystem::path& file) { write_text(file, parameters_csv(step.fitted)); },
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
    timeline["floor"] = to_json(step.diagnosis.floor);
  });
}

std::string parameter_table(const Fitted& fitted) {
  std::vector<std::vector<std::string>> rows = {
      {"parameter", "value", "95 % interval", "unit", ""}};
  const auto parameters = fitted.form.parameters();
  for (size_t i = 0; i < parameters.size(); ++i)
    rows.push_back({parameters[i].name, fmt::format("{:.5g}", fitted.p[i]),
                    fmt::format("{:.5g} .. {:.5g}", fitted.low[i], fitted.high[i]),
                    parameters[i].unit, parameters[i].long_name.substr(0, 40)});
  std::string text = table(rows);
  for (const auto& sentence : fitted.undetermined) text += "  " + sentence + "\n";
  return text;
}

std::string photo_table(const Scene& scene, const Fitted& fitted, const Floor& floor) {
  std::vector<std::vector<std::string>> rows = {
      {"example", "camera", "use", "chi", "over floor", "rms px", "what is left"}};
  for (const auto& example : fitted.evaluation.examples)
    for (const auto& photo : example.photos) {
      const auto& spec = scene.capture.examples[example.example];
      const bool noise = flow_statistics(photo.flow).whiteness_p > 0.01;
      rows.push_back({spec.name, spec.photos[photo.photo].camera,
                      example.held_out ? "validate" : "fit", fmt::format("{:.2f}", photo.chi()),
                      fmt::format("{:.2f}", photo.chi() / floor.chi),
                      fmt::format("{:.3f}", photo.flow.rms_px()), noise ? "noise" : "structure"});
    }
  return table(rows);
}

std::string bar(double share, int width) {
  const int full = static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * width));
  return fmt::format("{:4.0f} % {}{}", 100.0 * share, std::string(full, '#'),
                     std::string(width - full, '.'));
}

std::string diagnosis_table(const Diagnosis& diagnosis, size_t most) {
  std::vector<std::vector<std::string>> rows = {
      {"effect", "would remove", "evidence", "p", "dof", "easily taken for"}};
  std::string sentences, untestable;
  for (const auto& effect : diagnosis.effects) {
    if (!effect.testable) {
      untestable += fmt::format("  {}: {}\n", effect.effect, effect.why_not);
      continue;
    }
    if (rows.size() > most) continue;
    std::string confused;
    for (const auto& other : effect.confused_with)
      if (confused.size() < 30) confused += (confused.empty() ? "" : ", ") + other.effect;
    rows.push_back({effect.effect, bar(effect.explains), fmt::format("{:.1f}", effect.evidence),
                    fmt::format("{:.3f}", effect.p_value), fmt::format("{}", effect.dof),
                    confused});
    if (rows.size() <= 4 && nameable(effect, diagnosis)) sentences += "  " + effect.why + "\n";
  }
  return table(rows) +
         fmt::format(
             "  named only above evidence {:.1f} (chance alone reaches it in 5 % of runs)\n",
             std::max(diagnosis.gate, kNameable)) +
         sentences + (untestable.empty() ? "" : "not tested\n" + untestable);
}

}  // namespace hookeye
