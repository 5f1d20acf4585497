// The figures of a step as product.md's JSON.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "estimation/search/discover.h"

namespace hookeye {

nlohmann::json to_json(const FitToAll& all);
/// The step's entry of run.json.
nlohmann::json timeline_entry(const Step& step);
/// metrics.json: chi, rms_px and whiteness of every photo, by camera, example and region, measured
/// forces, what is undetermined, the material's card and curves, the facts of the mesh.
nlohmann::json metrics(const Scene& scene, const Fitted& fitted, const Floor& floor);

/// diagnosis.json: to_json() of it, and `parameters`, `energy` and `material` with intervals and
/// bands that reach for the mesh (reach_for_mesh), of which only a diagnosis knows: they stand
/// before those of parameters.csv and metrics.json, which stay as the fit told them.
nlohmann::json diagnosis_json(const Step& step);

/// parameters.csv: name, unit, words, value and interval of each.
std::string parameters_csv(const Fitted& fitted);

/// Fills a step's folder: model.yaml, metrics.json, diagnosis.json, parameters.csv,
/// residuals/EXAMPLE-CAMERA.{exr,png}, compare/EXAMPLE-CAMERA.png, deformed/EXAMPLE.vtu, and what
/// the page draws: page/ (page_data.h).
void write_step(const std::filesystem::path& folder, const Scene& scene, const Step& step);
/// Those by name, with what writes each; scene and step outlive it.
using StepFiles = std::map<std::string, std::function<void(const std::filesystem::path&)>>;
StepFiles step_files(const Scene& scene, const Step& step);

}  // namespace hookeye
