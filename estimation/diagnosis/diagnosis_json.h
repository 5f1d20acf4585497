// What is missing, and where, as product.md's JSON.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "estimation/diagnosis/diagnosis.h"
#include "estimation/diagnosis/free_form.h"

namespace hookeye {

nlohmann::json to_json(const Floor& floor);
nlohmann::json to_json(const Diagnosis& diagnosis);
/// The same with all digits, so that what is read back is what was written.
nlohmann::json to_archive(const Diagnosis& diagnosis);
/// Which guard keeps a tested effect from being named (nameable), with its figures; "": it is named
/// or was not tested.
std::string not_named_because(const EffectScore& score, const Diagnosis& diagnosis);
/// A diagnosis as to_json() wrote it, for the model it was made of: what `plan` and `add` need of
/// it. Throws InputError (`file`) where it is not one.
Diagnosis diagnosis_from_json(const nlohmann::json& document, const Model& model,
                              const std::filesystem::path& file);
/// Without the forces at the nodes, which are in the vtu.
nlohmann::json to_json(const std::vector<FreeForm>& fields);
/// chi by use, and all parameters, without intervals: those would have to reach for the mesh.

}  // namespace hookeye
