// The figures of a step as product.md's JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "estimation/discover.h"
#include "estimation/free_form.h"
#include "estimation/plan.h"

namespace hookeye {

nlohmann::json to_json(const Floor& floor);
/// Name, unit, words and value of each; `low` and `high` where they are told.
nlohmann::json parameters_json(const std::vector<Parameter>& parameters, const VectorXd& value,
                               const VectorXd* low, const VectorXd* high);
nlohmann::json to_json(const Diagnosis& diagnosis);
/// Which guard keeps a tested effect from being named (nameable), with its figures; "": it is named
/// or was not tested.
std::string not_named_because(const EffectScore& score, const Diagnosis& diagnosis);
/// A diagnosis as to_json() wrote it, for the model it was made of: what `plan` and `add` need of
/// it. Throws InputError (`file`) where it is not one.
Diagnosis diagnosis_from_json(const nlohmann::json& document, const Model& model,
                              const std::filesystem::path& file);
nlohmann::json to_json(const Plan& plan);
/// Without the forces at the nodes, which are in the vtu.
nlohmann::json to_json(const std::vector<FreeForm>& fields);
/// chi by use, and all parameters, without intervals: those would have to reach for the mesh.
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

}  // namespace hookeye
