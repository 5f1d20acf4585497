// polyfem: a JSON file a load case, with mesh.msh (gmsh 2.2) and faces.txt.
//
// What is written follows PolyFEM's sources and json-specs (2026):
// - MooneyRivlin3Param: c1 (I1bar - 3) + c2 (I2bar - 3) + c3 (..)(..) + d1 (J - 1)^2: d1 = kappa/2.
//   UnconstrainedOgden: sum 2 mu_i/alpha_i^2 (sum of isochoric stretches^alpha_i - 3) + 1/D (J -
//   1)^2. Both are Hookeye's energy. (PolyFEM's NeoHookean is coupled, with log J. Not written.)
// - SaintVenant: stiffnesses of the Green strain, 11 22 33 23 13 12, upper triangle row by row.
// - `rhs` is an acceleration against which the body is pulled; tractions are dead; a pressure
//   pushes inwards on the deformed faces.
// - `discr_order: 2` makes its own nodes in the middle of the edges of linear tetrahedra.
// Conditions belong to faces: a set of patches has one id in faces.txt (id, three corners).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "exporters/deck.h"
#include "exporters/patches.h"
#include "exporters/xml_text.h"

namespace hookeye::polyfem {
namespace {

using Json = nlohmann::ordered_json;
using Out = std::back_insert_iterator<std::string>;

bool fits(const Rubber& r) { return r.c20 == 0 && r.c30 == 0; }

Json rubber(const Rubber& r) {
  if (fits(r) && !r.ogden.empty()) {
    Json alphas = Json::array(), mus = Json::array();
    for (const auto& [mu, alpha] : r.as_ogden()) {
      alphas.push_back(alpha);
      mus.push_back(0.5 * mu * alpha);
    }
    return {{"type", "UnconstrainedOgden"},
            {"alphas", alphas},
            {"mus", mus},
            {"Ds", Json::array({2.0 / r.some_kappa()})}};
  }
  return {{"type", "MooneyRivlin3Param"},
          {"c1", fits(r) ? r.c10 : 0.5 * r.mu()},
          {"c2", fits(r) ? r.c01 : 0.0},
          {"c3", 0.0},
          {"d1", 0.5 * r.some_kappa()}};
}

Json linear(const Stiffness6& C) {
  Json entries = Json::array();
  for (int a = 0; a < 6; ++a)
    for (int b = a; b < 6; ++b) entries.push_back(C(a, b));
  return {{"type", "SaintVenant"}, {"elasticity_tensor", entries}};
}

/// One entry a material; all of one type where any is a sum.
Json materials(const SolverModel& model, double factor) {
  bool sums = false;
  for (const SolverMaterial& m : model.materials) sums |= deck::has_both(m);
  Json out = Json::array();
  for (size_t i = 0; i < model.materials.size(); ++i) {
    const SolverMaterial& m = model.materials[i];
    Json parts = Json::array();
    if (!m.rubber.none()) parts.push_back(rubber(m.rubber.scaled(factor)));
    if (!m.linear.isZero(0.0)) parts.push_back(linear(m.linear * factor));
    Json one = sums ? Json{{"type", "MaterialSum"}, {"models", parts}} : parts.at(0);
    one["id"] = i + 1;
    one["rho"] = model.density;
    out.push_back(std::move(one));
  }
  return out;
}

/// Corners alone, numbered in their order.
std::vector<int> corner_numbers(const TetMesh& mesh) {
  std::vector<int> out(static_cast<size_t>(mesh.nodes()), -1);
  for (int e = 0; e < mesh.size(); ++e)
    for (int k = 0; k < 4; ++k) out[static_cast<size_t>(mesh.elements(k, e))] = 0;
  int next = 0;
  for (int& number : out)
    if (number == 0) number = next++;
  return out;
}

std::string msh(const SolverModel& model) {
  const TetMesh& mesh = model.mesh();
  const auto corners = corner_numbers(mesh);
  const auto count = std::count_if(corners.begin(), corners.end(), [](int n) { return n >= 0; });
  std::string out = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", count);
  for (int n = 0; n < mesh.nodes(); ++n)
    if (const int corner = corners[static_cast<size_t>(n)]; corner >= 0)
      fmt::format_to(Out(out), "{} {:.17g} {:.17g} {:.17g}\n", corner + 1, mesh.X(0, n),
                     mesh.X(1, n), mesh.X(2, n));
  std::vector<size_t> material(static_cast<size_t>(mesh.size()));
  for (size_t i = 0; i < model.materials.size(); ++i)
    for (const int e : model.materials[i].elements) material[static_cast<size_t>(e)] = i + 1;
  fmt::format_to(Out(out), "$EndNodes\n$Elements\n{}\n", mesh.size());
  for (int e = 0; e < mesh.size(); ++e) {
    fmt::format_to(Out(out), "{0} 4 2 {1} {1}", e + 1, material[static_cast<size_t>(e)]);
    for (int k = 0; k < 4; ++k)
      fmt::format_to(Out(out), " {}", corners[static_cast<size_t>(mesh.elements(k, e))] + 1);
    out += "\n";
  }
  return out + "$EndElements\n";
}

/// Ids of faces: each set of patches that faces share has one, from 1.
class FaceIds {
 public:
  FaceIds(const TetMesh& mesh, const std::vector<Patch>& patches) {
    for (size_t p = 0; p < patches.size(); ++p)
      for (const int face : patches[p].faces) sets_[face].insert(p);
    for (const auto& [face, set] : sets_) ids_.try_emplace(set, static_cast<int>(ids_.size()) + 1);
    const auto corners = corner_numbers(mesh);
    for (const auto& [face, set] : sets_) {
      fmt::format_to(Out(text_), "{}", ids_.at(set));
      for (int k = 0; k < 3; ++k)
        fmt::format_to(Out(text_), " {}", corners[static_cast<size_t>(mesh.boundary(k, face))]);
      text_ += "\n";
    }
  }
  const std::string& text() const { return text_; }
  std::vector<int> of(size_t patch) const {
    std::vector<int> out;
    for (const auto& [set, id] : ids_)
      if (set.count(patch)) out.push_back(id);
    return out;
  }

 private:
  std::map<int, std::set<size_t>> sets_;
  std::map<std::set<size_t>, int> ids_;
  std::string text_;
};

std::string times_t(double value) { return fmt::format("{:.12g}*t", value + 0.0); }

Json conditions(const SolverCase& one, const CasePatches& patches, const FaceIds& ids) {
  std::map<int, std::array<std::string, 3>> held;
  std::map<int, Vector3d> traction;
  std::map<int, double> pressure;
  for (const HeldPatch& h : patches.held)
    for (const int id : ids.of(h.patch))
      for (int i = 0; i < 3; ++i)
        if (!h.motion[i].empty()) held[id][static_cast<size_t>(i)] = h.motion[i];
  for (const auto& [patch, t] : patches.tractions)
    for (const int id : ids.of(patch))
      traction.try_emplace(id, Vector3d::Zero()).first->second += t;
  for (const auto& [patch, p] : patches.pressures)
    for (const int id : ids.of(patch)) pressure[id] += p;
  Json out = {{"rhs", Json::array()},
              {"dirichlet_boundary", Json::array()},
              {"neumann_boundary", Json::array()},
              {"pressure_boundary", Json::array()}};
  for (int i = 0; i < 3; ++i) out["rhs"].push_back(times_t(-one.gravity[i]));
  for (const auto& [id, motion] : held) {
    Json value = Json::array(), dimension = Json::array();
    for (const std::string& m : motion) {
      value.push_back(m.empty() ? "0" : m);
      dimension.push_back(!m.empty());
    }
    out["dirichlet_boundary"].push_back({{"id", id}, {"value", value}, {"dimension", dimension}});
  }
  for (const auto& [id, t] : traction)
    out["neumann_boundary"].push_back(
        {{"id", id}, {"value", Json::array({times_t(t.x()), times_t(t.y()), times_t(t.z())})}});
  for (const auto& [id, p] : pressure)
    out["pressure_boundary"].push_back({{"id", id}, {"value", times_t(p)}});
  return out;
}

Json document(const SolverModel& model, const SolverCase& one, Json boundary) {
  const int steps = static_cast<int>(5 * one.shares.size());
  const Json geometry = {{"mesh", "mesh.msh"}, {"surface_selection", "faces.txt"}};
  return {{"geometry", Json::array({geometry})},
          {"space", {{"discr_order", model.mesh().order}}},
          {"time", {{"t0", 0}, {"tend", 1}, {"time_steps", steps}, {"quasistatic", true}}},
          {"materials", materials(model, one.stiffness)},
          {"boundary_conditions", std::move(boundary)},
          {"output", {{"paraview", {{"file_name", one.file + ".pvd"}}}}}};
}

class PolyFEM final : public Exporter {
 public:
  std::string name() const override { return "polyfem"; }
  std::string title() const override { return "a PolyFEM JSON file a load case"; }
  Exported write(const SolverModel& model) const override {
    Exported out;
    const Patches patches = patches_of(model);
    const FaceIds ids(model.mesh(), patches.all);
    out.files = {{"mesh.msh", msh(model)}, {"faces.txt", ids.text()}};
    for (size_t c = 0; c < model.cases.size(); ++c) {
      const SolverCase& one = model.cases[c];
      if (!one.strains) continue;
      Json boundary = conditions(one, patches.cases[c], ids);
      out.files.emplace_back(one.file + ".json",
                             document(model, one, std::move(boundary)).dump(2) + "\n");
    }
    for (const SolverMaterial& m : model.materials)
      if (!fits(m.rubber)) {
        out.lacks.push_back(
            "powers of I1bar are in no law of PolyFEM's: they are replaced by neo-Hooke of the "
            "shear modulus at rest");
        break;
      }
    if (model.energy.swelling.size() > 0) out.lacks.push_back("swelling is left out");
    out.lacks.insert(out.lacks.end(), patches.lacks.begin(), patches.lacks.end());
    add_case_lacks(model, "PolyFEM", out.lacks);
    out.notes = {
        "PolyFEM_bin --json CASE.json. Written from PolyFEM's sources and not run in it "
        "by the authors of this export.",
        "MooneyRivlin3Param and UnconstrainedOgden have Hookeye's volumetric energy, "
        "kappa/2 (J - 1)^2. PolyFEM's NeoHookean has another.",
        "mesh.msh has the corners alone, in the order of their numbers here. PolyFEM adds "
        "the nodes in the middle of straight edges (discr_order 2)."};
    return out;
  }
};

}  // namespace
}  // namespace hookeye::polyfem

HOOKEYE_DEFINE_EXPORTER(polyfem, polyfem::PolyFEM)
