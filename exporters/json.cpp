// json: the whole model in one document, nothing left out. docs/export.md tells its keys.
#include <nlohmann/json.hpp>

#include "exporters/exporter.h"

namespace hookeye::json_document {
namespace {

using Json = nlohmann::ordered_json;

Json numbers(const VectorXd& v) { return std::vector<double>(v.data(), v.data() + v.size()); }

/// A list of its columns.
template <class Matrix>
Json columns(const Eigen::MatrixBase<Matrix>& values) {
  using Scalar = typename Matrix::Scalar;
  Json out = Json::array();
  for (Eigen::Index i = 0; i < values.cols(); ++i) {
    const Eigen::VectorX<Scalar> column = values.col(i);
    out.push_back(std::vector<Scalar>(column.data(), column.data() + column.size()));
  }
  return out;
}

Json parameters_of(const std::vector<Parameter>& parameters) {
  Json out = Json::array();
  for (const Parameter& p : parameters)
    out.push_back({{"name", p.name}, {"value", p.value}, {"unit", p.unit}, {"what", p.long_name}});
  return out;
}

Json law(const EnergyTerm& term, const Units& units) {
  Json out = {{"law", term.name()}};
  if (const auto* terms = terms_of(term)) {
    out["terms"] = Json::array();
    for (const WeightedTerm& t : *terms) {
      out["terms"].push_back(law(*t.term, units));
      out["terms"].back()["coefficient"] = t.coefficient;
    }
  } else {
    out["parameters"] = parameters_of(term.parameters(units));
  }
  return out;
}

Json materials(const SolverModel& model) {
  Json parts = Json::array();
  for (const auto& part : model.energy.parts) {
    Json one = law(*part.term, model.units);
    one["weight"] = part.weight.size() ? numbers(part.weight) : Json(nullptr);
    if (part.frames.size()) one["frames"] = columns(part.frames);
    parts.push_back(std::move(one));
  }
  Json sets = Json::array();
  for (const SolverMaterial& m : model.materials) {
    Json ogden = Json::array();
    for (const auto& [mu, alpha] : m.rubber.ogden) ogden.push_back({{"mu", mu}, {"alpha", alpha}});
    sets.push_back({{"name", m.name},
                    {"elements", m.elements},
                    {"c10", m.rubber.c10},
                    {"c01", m.rubber.c01},
                    {"c20", m.rubber.c20},
                    {"c30", m.rubber.c30},
                    {"ogden", std::move(ogden)},
                    {"kappa", m.rubber.kappa},
                    {"stiffness", m.linear.isZero(0.0) ? Json(nullptr) : columns(m.linear)}});
  }
  return {{"parts", std::move(parts)},
          {"swelling", model.energy.swelling.size() ? numbers(model.energy.swelling) : nullptr},
          {"sets", std::move(sets)},
          {"sets_lack", model.lacks}};
}

Json faces(const std::vector<std::pair<int, double>>& all) {
  Json out = Json::array();
  for (const auto& [face, fraction] : all) out.push_back({face, fraction});
  return out;
}

Json forces(const SolverCase& one) {
  Json out = Json::array();
  for (Eigen::Index n = 0; 3 * n < one.nodal_force.size(); ++n) {
    const Vector3d f = one.nodal_force.segment<3>(3 * n);
    if (!f.isZero(0.0)) out.push_back({{"node", n}, {"force", numbers(f)}});
  }
  return out;
}

Json load_case(const SolverModel& model, const SolverCase& one) {
  const auto& loading = one.loading;
  Json held = Json::array(), turns = Json::array(), pressures = Json::array(), beds = Json::array(),
       floors = Json::array();
  for (size_t i = 0; i < loading.prescribed.size(); ++i)
    held.push_back({{"node", loading.prescribed[i] / 3},
                    {"component", loading.prescribed[i] % 3},
                    {"displacement", loading.displacement[static_cast<Eigen::Index>(i)]}});
  for (const auto& turn : loading.turns)
    turns.push_back({{"nodes", turn.nodes},
                     {"axis", numbers(turn.motion.axis)},
                     {"degrees", turn.motion.degrees},
                     {"center", numbers(turn.motion.center)},
                     {"move", numbers(turn.motion.move)}});
  for (const PressureOn& p : one.pressures)
    pressures.push_back({{"pressure", p.pressure}, {"faces", faces(p.faces)}});
  for (const FoundationOn& bed : one.foundations)
    beds.push_back({{"k_normal", bed.k_normal},
                    {"k_tangent", bed.k_tangent},
                    {"faces", faces(bed.faces)},
                    {"rests_at", columns(bed.target.reshaped(3, model.mesh().nodes()))}});
  for (const FloorPlane& floor : one.floors)
    floors.push_back({{"point", numbers(floor.point)},
                      {"normal", numbers(floor.normal)},
                      {"k", floor.k},
                      {"smoothing", floor.smoothing}});
  Json found = nullptr;
  if (one.displacement)
    found = {{"displacement", columns(one.displacement->reshaped(3, model.mesh().nodes()))},
             {"volume_ratio", {one.lowest_J, one.highest_J}}};
  return {{"name", one.name},
          {"use", one.use},
          {"stiffness_factor", one.stiffness},
          {"gravity", numbers(one.gravity)},
          {"prescribed", std::move(held)},
          {"turns", std::move(turns)},
          {"nodal_forces", forces(one)},
          {"pressures", std::move(pressures)},
          {"foundations", std::move(beds)},
          {"floors", std::move(floors)},
          {"found", std::move(found)}};
}

Json mesh(const SolverModel& model) {
  const TetMesh& mesh = model.mesh();
  Json sets = Json::object(), patches = Json::object();
  for (const auto& [name, region] : model.regions) {
    sets[name] = region->nodes;
    patches[name] = faces(region->faces);
  }
  return {{"order", mesh.order},
          {"nodes", columns(mesh.X)},
          {"elements", columns(mesh.elements)},
          {"boundary", columns(mesh.boundary)},
          {"boundary_element", mesh.boundary_element},
          {"node_sets", std::move(sets)},
          {"face_sets", std::move(patches)}};
}

class JsonExporter final : public Exporter {
 public:
  std::string name() const override { return "json"; }
  std::string title() const override { return "the whole model in one JSON document"; }
  Exported write(const SolverModel& model) const override {
    const Units& u = model.units;
    Json document = {{"hookeye", 1},
                     {"document", "model"},
                     {"title", model.title},
                     {"step", model.step},
                     {"units",
                      {{"length", u.length},
                       {"force", u.force},
                       {"stress", u.stress()},
                       {"density", u.force + " s^2/" + u.length + "^4"},
                       {"acceleration", u.acceleration()}}},
                     {"mesh", mesh(model)},
                     {"density", model.density_told ? Json(model.density) : Json(nullptr)},
                     {"material", materials(model)},
                     {"added", Json::array()},
                     {"load_cases", Json::array()}};
    for (const Added& a : model.added)
      document["added"].push_back({{"name", a.name},
                                   {"variant", a.variant},
                                   {"sentence", a.sentence},
                                   {"mechanical", a.mechanical},
                                   {"parameters", parameters_of(a.parameters)}});
    for (const SolverCase& one : model.cases)
      document["load_cases"].push_back(load_case(model, one));
    Exported out;
    out.files.emplace_back("model.json", document.dump() + "\n");
    out.notes = {
        "model.json holds nodes, elements, energies, loads and what was found: its keys "
        "are in docs/export.md. Counts are from 0."};
    return out;
  }
};

}  // namespace
}  // namespace hookeye::json_document

HOOKEYE_DEFINE_EXPORTER(json, json_document::JsonExporter)
