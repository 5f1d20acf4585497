#include "runs/record.h"

#include <algorithm>
#include <cmath>

#include "core/json_file.h"
#include "core/text_file.h"
#include "core/work_clock.h"
#include "estimation/diagnosis/diagnosis_json.h"
#include "estimation/fit/at_floor.h"
#include "estimation/fit/over_all_pixels.h"
#include "estimation/output/page_data.h"
#include "estimation/output/pixels_json.h"
#include "estimation/output/removed.h"
#include "estimation/output/step_json.h"
#include "estimation/search/contest.h"
#include "runs/decision_log.h"
#include "runs/failed.h"
#include "runs/tables.h"
#include "runs/versions.h"

namespace hookeye {

using nlohmann::json;

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
  const WorkingAt stage(WorkStage::pictures);
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

namespace {

void displace(Bench& bench, Step& step, const std::atomic<bool>* cancel) {
  if (!lacks_displaced(step.diagnosis)) return;
  if (auto done = displace_again(bench.workspace, step.fitted, cancel, step.diagnosis); !done)
    fail(std::move(done.error()));
}

}  // namespace

Step with_displaced(Bench& bench, Step step, const std::atomic<bool>* cancel) {
  displace(bench, step, cancel);
  return step;
}

void record_all_pixels(Run& run, Bench& bench, Step& step, const FitOptions& options) {
  const auto known = all_pixels_in(run.timeline().at("steps").back().value("all_pixels", json()),
                                   step.fitted.form.parameters());
  if (known) {
    take_all_pixels(*known, &step.fitted);
    return;
  }
  auto result = value_or_fail(over_all_pixels(bench.workspace, step.fitted, options));
  if (!result) return;
  step.fitted.low = result->low, step.fitted.high = result->high;
  step.fitted.all_pixels = result->all_pixels;
  Step whole = step;
  whole.fitted = std::move(*result);
  const WorkingAt stage(WorkStage::pictures);
  const auto folder = run.steps().back();
  for (const auto& [name, write] : step_files(*whole.fitted.form.scene, whole))
    if (name != "removed") run.add_file(folder, name, write, true);
  const json entry = timeline_entry(whole);
  run.update([&](json& timeline) {
    for (const char* key : {"parameters", "says", "all_pixels", "undetermined"})
      timeline["steps"].back()[key] = entry.at(key);
  });
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
    timeline["steps"].back()["says"] = entry["says"];  // with their ranges
    if (entry.contains("gate")) timeline["steps"].back()["gate"] = entry["gate"];
    tell_floor(timeline, step.diagnosis.floor);
  });
}

void diagnose_newest(Run& run, Bench& bench, Step& step, const DiagnosisOptions& options) {
  step.diagnosis = value_or_fail(diagnose(bench.workspace, step.fitted, options));
  reach_for_mesh(step.fitted, step.diagnosis);
  displace(bench, step, options.cancel);  // where it throws, the caller's step is whole
  record_diagnosis(run, step);
  log_naming(run, step.diagnosis);
}

std::vector<FreeForm> tell_free_form(const Run& run, Bench& bench, const Step& step,
                                     const std::atomic<bool>* cancel) {
  const std::filesystem::path folder = run.steps().back();
  for (const char* stale : {"free_form.json", "free_form.vtu", "page/free_form.json"})
    std::filesystem::remove(folder / stale);
  if (at_floor(step.fitted, step.diagnosis.floor)) return {};
  auto fields = value_or_fail(free_form(bench.workspace, step.fitted, cancel));
  if (fields.empty()) return {};
  write_text(folder / "free_form.json", to_json(fields).dump(1) + "\n");
  const std::vector<FreeForm> drawn(fields.begin(),
                                    fields.begin() + std::min(fields.size(), kDrawnFreeForms));
  write_free_form(folder / "free_form.vtu", *step.fitted.form.scene, drawn);
  write_page_free_form(folder / "page", *step.fitted.form.scene, drawn);
  return fields;
}

}  // namespace hookeye
