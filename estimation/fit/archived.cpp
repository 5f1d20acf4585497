#include "estimation/fit/archived.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/fingerprint.h"
#include "estimation/evaluation/normal_equations.h"

namespace hookeye {

using nlohmann::json;

namespace {

template <class Array>
std::string fingerprint_of_numbers(const Array& numbers) {
  return fingerprint_of({reinterpret_cast<const char*>(numbers.data()),
                         static_cast<size_t>(numbers.size()) * sizeof(*numbers.data())});
}

std::string text_of(const Scene& scene) {
  const TetMesh& mesh = scene.body->mesh;
  std::string out = fmt::format("mesh {} {}; held out:", fingerprint_of_numbers(mesh.X),
                                fingerprint_of_numbers(mesh.elements));
  for (const ExampleSpec& example : scene.capture.examples) out += example.validate ? " 1" : " 0";
  return out;
}

/// Bounds and starts that scale with a model come out of it with its rounding.
std::string text_of(const Ingredient& ingredient) {
  std::string out = fmt::format("\n{} [{}]", ingredient.name(), ingredient.variant());
  for (const Parameter& one : ingredient.parameters())
    out += fmt::format("\n {} {:.5g} {:.5g} {:.5g} {:.5g} {} {}", one.name, one.value, one.low,
                       one.high, one.typical, one.positive, one.example);
  return out;
}

}  // namespace

Question question_of(const std::string& kind, const ModelForm& form, const VectorXd& p) {
  Question out{kind, text_of(*form.scene), {}};
  for (const auto& ingredient : form.ingredients) out.text += text_of(*ingredient);
  const VectorXd x = Scaling{form.parameters()}.to_x(p);
  out.numbers.assign(x.begin(), x.end());
  return out;
}

json states_json(const Evaluation& evaluation) {
  json out = json::array();
  for (const ExampleEvaluation& example : evaluation.examples) {
    const VectorXd& q = example.equilibrium->q;
    std::vector<std::uint8_t> bytes(static_cast<size_t>(q.size()) * sizeof(double));
    std::memcpy(bytes.data(), q.data(), bytes.size());
    out.push_back({{"example", example.example}, {"position", json::binary(std::move(bytes))}});
  }
  return out;
}

Workspace::Place place_from(const json& states, Workspace::Place before) {
  const Eigen::Index unknowns = before.scene->body->mesh.X.size();
  for (const json& state : states) {
    const auto& bytes = state.at("position").get_binary();
    if (bytes.size() != static_cast<size_t>(unknowns) * sizeof(double)) continue;
    VectorXd& q = before.q.at(state.at("example"));
    q.resize(unknowns);
    std::memcpy(q.data(), bytes.data(), bytes.size());
  }
  return before;
}

std::string mark_of(const Workspace::Place& place) {
  std::string marks;
  for (const VectorXd& q : place.q) marks += fingerprint_of_numbers(q);
  return fingerprint_of(marks);
}

Workspace::Place place_in(const Workspace& workspace, const std::shared_ptr<const Scene>& scene) {
  Workspace::Place place = workspace.place();
  if (place.scene == scene) return place;
  return {scene, std::vector<VectorXd>(scene->capture.examples.size())};
}

Workspace::Place place_after(Workspace::Place before, const Fitted& fitted) {
  for (const ExampleEvaluation& example : fitted.evaluation.examples)
    before.q[example.example] = example.equilibrium->q;
  return before;
}

json vector_json(const VectorXd& v) { return std::vector<double>(v.begin(), v.end()); }

VectorXd vector_from(const json& list) {
  const auto numbers = list.get<std::vector<double>>();
  return VectorXd::Map(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

json failure_json(const NumericalFailure& failure) {
  return {{"failed", failure.reason},
          {"example", failure.example},
          {"load_fraction", failure.load_fraction}};
}

std::optional<NumericalFailure> failure_from(const json& answer) {
  if (!answer.contains("failed")) return {};
  return NumericalFailure{answer.at("example"), answer.at("load_fraction"), answer.at("failed")};
}

}  // namespace hookeye
