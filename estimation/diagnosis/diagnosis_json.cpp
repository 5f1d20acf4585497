#include "estimation/diagnosis/diagnosis_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/distributions.h"
#include "core/input_error.h"
#include "estimation/effects/catalogue.h"
#include "estimation/model/parameters_json.h"

namespace hookeye {

using nlohmann::json;

namespace {

/// Of an archive alone: an interval is cut at bounds, and rounds.
constexpr const char* kStandardError = "standard_error";

json effect_json(const EffectScore& score) {
  json out = {{"effect", score.effect}, {"testable", score.testable}};
  if (!score.why_not.empty()) out["why_not"] = score.why_not;
  if (!score.best) return out;
  out["variant"] = score.best->variant();
  out["explains"] = score.explains;
  out["explains_held_out"] = score.explains_held_out;
  out["fall"] = score.fall;
  out["fall_held_out"] = score.fall_held_out;
  out["measured_fall"] = score.measured_fall;
  out["mesh_fall"] = score.mesh_fall;
  out["dof"] = score.dof;
  out["evidence"] = score.evidence;
  out["bic"] = score.bic;
  out["p_value"] = score.p_value;
  out["weight"] = score.weight;
  out["confused_with"] = json::array();
  out["confusion"] = json::array();
  for (const auto& other : score.confused_with) {
    out["confused_with"].push_back(other.effect);
    out["confusion"].push_back({{"effect", other.effect}, {"cosine", other.cosine}});
  }
  out["why"] = score.why;
  if (score.pictured) out["pictures"] = "removed/" + score.effect;
  const VectorXd low = score.values - kNormal95 * score.standard_error;
  const VectorXd high = score.values + kNormal95 * score.standard_error;
  out["predicted"] = parameters_json(score.best->parameters(), score.values, &low, &high);
  out["fitted_move"] = std::vector<double>(score.base_step.begin(), score.base_step.end());
  if (score.other_form) out["other_form"] = effect_json(*score.other_form);
  return out;
}

}  // namespace

namespace {

/// "0.0012 (as much as 0.006 px of motion of the whole surface)".
std::string fall_text(double fall, const Floor& floor) {
  return floor.per_px2 > 0.0 ? fmt::format("{:.2g} (as {:.2g} px of motion all over the surface)",
                                           fall, std::sqrt(std::max(0.0, fall) / floor.per_px2))
                             : fmt::format("{:.2g}", fall);
}

}  // namespace

std::string not_named_because(const EffectScore& score, const Diagnosis& diagnosis) {
  if (!score.testable || nameable(score, diagnosis)) return "";
  if (score.evidence < diagnosis.gate)
    return fmt::format(
        "its log Bayes factor {:.1f} is below {:.1f}, the 95 % critical value over all effects, "
        "which chance alone exceeds in 5 % of runs",
        score.evidence, diagnosis.gate);
  if (score.evidence < diagnosis.limits().nameable)
    return fmt::format("its log Bayes factor {:.1f} is below {:g}, which is asked for in any case",
                       score.evidence, diagnosis.limits().nameable);
  const double renderer = renderers_err_by(diagnosis.floor);
  const bool mesh = score.mesh_fall > renderer;
  return fmt::format(
      "its log Bayes factor {:.1f} is above the critical value {:.1f}, but that knows of noise "
      "alone: it would lower the squared residual by {}, and {} may be as much as {}",
      score.evidence, std::max(diagnosis.gate, diagnosis.limits().nameable),
      fall_text(score.fall, diagnosis.floor),
      mesh ? "the mesh's own error" : "the error of a renderer or a lens",
      fall_text(mesh ? score.mesh_fall : renderer, diagnosis.floor));
}

json to_json(const Floor& floor) {
  return {{"chi", floor.chi},
          {"cell_variance", floor.cell_variance},
          {"cell_inflation", floor.cell_inflation},
          {"per_px2", floor.per_px2},
          {"source", floor.source},
          {"copies", floor.copies},
          {"by_camera", floor.by_camera},
          {"moved_at_rest", floor.moved_at_rest}};
}

namespace {

json to_json(const std::vector<MotionLeft>& motions) {
  json out = json::array();
  for (const MotionLeft& motion : motions) {
    out.push_back({{"example", motion.example},
                   {"photo", motion.photo},
                   {"held_out", motion.held_out},
                   {"px", motion.px},
                   {"most_px", motion.most_px}});
    if (motion.field) out.back()["field"] = true;
  }
  return out;
}

}  // namespace

json to_json(const Diagnosis& diagnosis) {
  json effects = json::array();
  for (const auto& score : diagnosis.effects) {
    effects.push_back(effect_json(score));
    effects.back()["named"] = nameable(score, diagnosis);
    if (const auto why = not_named_because(score, diagnosis); !why.empty())
      effects.back()["why_not_named"] = why;
  }
  return {
      {"floor", to_json(diagnosis.floor)},
      {"motions", to_json(diagnosis.motions)},
      {"gate", diagnosis.gate},
      {"effective_count", diagnosis.effective_count},
      {"whiteness_p", diagnosis.whiteness_p},
      {"mesh_shift", std::vector<double>(diagnosis.mesh_shift.begin(), diagnosis.mesh_shift.end())},
      {"mesh_note", diagnosis.mesh_note},
      {"mesh_fall", diagnosis.mesh_fall},
      {"mesh_fall_held_out", diagnosis.mesh_fall_held_out},
      {"held_out_missed", diagnosis.held_out_missed},
      {"held_out_over", diagnosis.held_out_over},
      {"mesh_in_measured", diagnosis.mesh_in_measured},
      {"leaders", leaders(diagnosis)},
      {"conclusion", conclusion(diagnosis)},
      {"effects", std::move(effects)}};
}

namespace {

void tell_errors(const EffectScore& score, json& out) {
  const VectorXd& error = score.standard_error;
  out[kStandardError] = std::vector<double>(error.begin(), error.end());
  if (score.other_form) tell_errors(*score.other_form, out.at("other_form"));
}

}  // namespace

json to_archive(const Diagnosis& diagnosis) {
  json out = to_json(diagnosis);
  for (size_t i = 0; i < diagnosis.effects.size(); ++i)
    if (diagnosis.effects[i].best) tell_errors(diagnosis.effects[i], out.at("effects").at(i));
  return out;
}

namespace {

EffectScore score_from_json(const json& one, const Model& model) {
  EffectScore score;
  score.effect = one.at("effect");
  score.testable = one.at("testable");
  score.why_not = one.value("why_not", "");
  if (!one.contains("variant")) return score;
  const Effect* effect = find_effect(score.effect);
  if (effect) score.best = effect->candidate(model, one.at("variant"));
  const json& predicted = one.at("predicted");
  if (!score.best || score.best->parameters().size() != predicted.size())
    throw std::runtime_error("effect " + score.effect);
  score.pictured = one.contains("pictures");
  score.dof = one.at("dof");
  if (score.dof < 0 || static_cast<size_t>(score.dof) > predicted.size())
    throw std::runtime_error("effect " + score.effect);
  score.values.resize(score.dof);
  score.standard_error.resize(score.dof);
  for (int i = 0; i < score.dof; ++i) {
    score.values[i] = predicted[i].at("value");
    score.standard_error[i] = (predicted[i].at("high").get<double>() - score.values[i]) / kNormal95;
  }
  if (const auto error = one.find(kStandardError); error != one.end())
    for (int i = 0; i < score.dof; ++i) score.standard_error[i] = error->at(i);
  const auto step = one.value("fitted_move", std::vector<double>{});
  score.base_step = VectorXd::Map(step.data(), static_cast<Eigen::Index>(step.size()));
  score.explains = one.at("explains");
  score.explains_held_out = one.at("explains_held_out");
  score.fall = one.at("fall");
  score.fall_held_out = one.value("fall_held_out", 0.0);
  score.measured_fall = one.value("measured_fall", 0.0);
  score.mesh_fall = one.value("mesh_fall", 0.0);
  score.evidence = one.at("evidence");
  score.bic = one.value("bic", score.evidence);
  score.p_value = one.at("p_value");
  score.weight = one.at("weight");
  for (const auto& other : one.at("confusion"))
    score.confused_with.push_back({other.at("effect"), other.at("cosine")});
  score.why = one.at("why");
  if (one.contains("other_form"))
    score.other_form = std::make_shared<EffectScore>(score_from_json(one.at("other_form"), model));
  return score;
}

}  // namespace

namespace {

/// Of a diagnosis that is older than they are: none.
std::vector<MotionLeft> motions_from_json(const json& list, const Scene& scene) {
  std::vector<MotionLeft> out;
  for (const json& one : list) {
    out.push_back({one.at("example"), one.at("photo"), one.at("held_out"), one.at("px"),
                   one.at("most_px"), one.value("field", false)});
    const ExampleSpec& example = scene.capture.examples.at(out.back().example);
    if (out.back().field)
      (void)example.measured.at(out.back().photo);
    else
      (void)example.photos.at(out.back().photo);
  }
  return out;
}

}  // namespace

Diagnosis diagnosis_from_json(const json& document, const Model& model,
                              const std::filesystem::path& file) {
  Diagnosis out;
  try {
    out.floor.limits = model.scene->limits;
    const json& floor = document.at("floor");
    out.floor.chi = floor.at("chi");
    out.floor.cell_variance = floor.at("cell_variance");
    out.floor.cell_inflation = floor.value("cell_inflation", 1.0);
    out.floor.per_px2 = floor.value("per_px2", 0.0);
    out.floor.source = floor.at("source");
    out.floor.copies = floor.value("copies", 0.0);
    out.floor.by_camera = floor.value("by_camera", out.floor.by_camera);
    out.floor.moved_at_rest = floor.value("moved_at_rest", out.floor.moved_at_rest);
    out.motions = motions_from_json(document.value("motions", json::array()), *model.scene);
    out.gate = document.at("gate");
    out.effective_count = document.at("effective_count");
    out.whiteness_p = document.at("whiteness_p");
    const auto shift = document.value("mesh_shift", std::vector<double>{});
    out.mesh_shift = VectorXd::Map(shift.data(), static_cast<Eigen::Index>(shift.size()));
    out.mesh_note = document.value("mesh_note", "");
    out.mesh_fall = document.value("mesh_fall", 0.0);
    out.mesh_fall_held_out = document.value("mesh_fall_held_out", 0.0);
    out.held_out_missed = document.value("held_out_missed", false);
    out.held_out_over = document.value("held_out_over", false);
    out.mesh_in_measured = document.value("mesh_in_measured", 0.0);
    for (const auto& one : document.at("effects"))
      out.effects.push_back(score_from_json(one, model));
  } catch (const std::exception& error) {
    throw InputError({file.string()}, std::string("not a diagnosis of this model: ") + error.what(),
                     "make it anew with `hookeye diagnose RUN`");
  }
  return out;
}

json to_json(const std::vector<FreeForm>& fields) {
  json out = json::array();
  for (const FreeForm& field : fields) {
    const double most = field.forces.colwise().norm().maxCoeff();
    out.push_back({{"name", field.name},
                   {"example", field.example.empty() ? json() : json(field.example)},
                   {"evidence", field.evidence},
                   {"explains", field.explains},
                   {"explains_held_out", field.explains_held_out},
                   {"most", most},
                   {"unit", field.unit},
                   {"place", {field.place.x(), field.place.y(), field.place.z()}},
                   {"sentence", field.sentence}});
  }
  return out;
}

}  // namespace hookeye
