#include "exporters/deck.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

namespace hookeye::deck {
namespace {

using Out = std::back_insert_iterator<std::string>;

/// Up to 16 a line, from 1.
void list(const std::vector<int>& zero_based, std::string& out) {
  for (size_t i = 0; i < zero_based.size(); ++i)
    fmt::format_to(Out(out), "{}{}", zero_based[i] + 1,
                   i + 1 == zero_based.size() || i % 16 == 15 ? "\n" : ",");
}

std::string head(const SolverModel& model) {
  const Units& u = model.units;
  return fmt::format("** {}\n** step {} of a run of hookeye. Units: {}, {}, {}, s.\n",
                     model.title.empty() ? "untitled" : model.title, model.step, u.length, u.force,
                     u.stress());
}

void elements(const TetMesh& mesh, const std::vector<int>& which, const char* set, int offset,
              std::string& out) {
  fmt::format_to(Out(out), "*ELEMENT, TYPE={}, ELSET={}\n", mesh.order == 1 ? "C3D4" : "C3D10",
                 set);
  for (const int e : which) {
    fmt::format_to(Out(out), "{}", e + 1 + offset);
    for (int k = 0; k < mesh.nodes_per_element(); ++k)
      fmt::format_to(Out(out), ",{}", mesh.elements(kOrder[k], e) + 1);
    out += "\n";
  }
}

std::string mesh_cards(const SolverModel& model) {
  const TetMesh& mesh = model.mesh();
  std::string out = head(model);
  out += "*NODE, NSET=NALL\n";
  for (int n = 0; n < mesh.nodes(); ++n)
    fmt::format_to(Out(out), "{},{},{},{}\n", n + 1, number(mesh.X(0, n)), number(mesh.X(1, n)),
                   number(mesh.X(2, n)));
  std::vector<int> all(static_cast<size_t>(mesh.size())), twice;
  for (int e = 0; e < mesh.size(); ++e) all[static_cast<size_t>(e)] = e;
  elements(mesh, all, "EALL", 0, out);
  for (const SolverMaterial& m : model.materials)
    if (has_both(m)) twice.insert(twice.end(), m.elements.begin(), m.elements.end());
  if (!twice.empty()) elements(mesh, twice, "ETWICE", mesh.size(), out);
  for (const SolverMaterial& m : model.materials) {
    fmt::format_to(Out(out), "*ELSET, ELSET={}\n", m.name);
    list(m.elements, out);
    if (!has_both(m)) continue;
    std::vector<int> second;
    for (const int e : m.elements) second.push_back(e + mesh.size());
    fmt::format_to(Out(out), "*ELSET, ELSET={}_L\n", m.name);
    list(second, out);
  }
  const auto names = set_names(model);
  for (size_t r = 0; r < model.regions.size(); ++r) {
    fmt::format_to(Out(out), "** region {}\n*NSET, NSET={}\n", model.regions[r].first, names[r]);
    list(model.regions[r].second->nodes, out);
  }
  return out;
}

/// Unknowns that a whole region has prescribed alike are told by its set, the others one by one.
std::string boundary_cards(const SolverModel& model, const SolverCase& one, double share) {
  const TetMesh& mesh = model.mesh();
  const Loading& loading = one.loading;
  std::map<int, double> left;
  for (size_t i = 0; i < loading.prescribed.size(); ++i)
    left[loading.prescribed[i]] = loading.displacement_at(mesh.X, i, share);
  if (left.empty()) return {};
  std::string out = "*BOUNDARY\n";
  const auto names = set_names(model);
  const auto all = left;
  for (size_t r = 0; r < model.regions.size(); ++r)
    for (int i = 0; i < 3; ++i) {
      const std::vector<int>& nodes = model.regions[r].second->nodes;
      const auto first = all.find(3 * nodes.front() + i);
      if (first == all.end() || !left.count(3 * nodes.front() + i)) continue;
      const bool alike = std::all_of(nodes.begin(), nodes.end(), [&](int n) {
        const auto at = all.find(3 * n + i);
        return at != all.end() && at->second == first->second;
      });
      if (!alike) continue;
      fmt::format_to(Out(out), "{},{},{},{}\n", names[r], i + 1, i + 1, number(first->second));
      for (const int n : nodes) left.erase(3 * n + i);
    }
  for (const auto& [unknown, u] : left)
    fmt::format_to(Out(out), "{},{},{},{}\n", unknown / 3 + 1, unknown % 3 + 1, unknown % 3 + 1,
                   number(u));
  return out;
}

/// Forces that hold springs where they are at rest away from the body's rest.
VectorXd spring_offsets(const SolverModel& model, const SolverCase& one) {
  const TetMesh& mesh = model.mesh();
  VectorXd out = VectorXd::Zero(3 * mesh.nodes());
  for (const FoundationOn& bed : one.foundations) {
    const VectorXd away = bed.target - mesh.X.reshaped();
    if (away.isZero(0.0)) continue;
    // One force term alone: what it does to the body at rest.
    Region region;
    region.faces = bed.faces;
    VectorXd R = VectorXd::Zero(out.size());
    elastic_foundation(region, bed.k_normal, bed.k_tangent, bed.target)
        ->add_residual(mesh, mesh.X.reshaped(), 1.0, R);
    out -= R;
  }
  return out;
}

std::string load_cards(const SolverModel& model, const SolverCase& one, double share) {
  const TetMesh& mesh = model.mesh();
  const VectorXd force = share * (one.nodal_force + spring_offsets(model, one));
  std::string out;
  if (!force.isZero(0.0)) {
    out += "*CLOAD\n";
    for (Eigen::Index i = 0; i < force.size(); ++i)
      if (force[i] != 0.0)
        fmt::format_to(Out(out), "{},{},{}\n", i / 3 + 1, i % 3 + 1, number(force[i]));
  }
  std::map<int, double> pressure;
  for (const PressureOn& p : one.pressures)
    for (const auto& [face, fraction] : p.faces) pressure[face] += share * fraction * p.pressure;
  const double g = share * one.gravity.norm();
  if (pressure.empty() && g == 0.0) return out;
  out += "*DLOAD\n";
  if (g != 0.0) {
    const Vector3d along = one.gravity.normalized();
    fmt::format_to(Out(out), "EALL,GRAV,{},{},{},{}\n", number(g), number(along.x()),
                   number(along.y()), number(along.z()));
  }
  for (const auto& [face, value] : pressure)
    fmt::format_to(Out(out), "{},P{},{}\n", mesh.boundary_element[static_cast<size_t>(face)] + 1,
                   face_number(mesh, face), number(value));
  return out;
}

/// Strains of free swelling at the nodes, as temperatures with an expansion of 1: means over the
/// elements around, by volume.
VectorXd swelling_at_nodes(const SolverModel& model) {
  const TetMesh& mesh = model.mesh();
  VectorXd sum = VectorXd::Zero(mesh.nodes()), weight = sum;
  for (int e = 0; e < mesh.size(); ++e) {
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k)
      edges.col(k) = mesh.X.col(mesh.elements(k + 1, e)) - mesh.X.col(mesh.elements(0, e));
    const double volume = std::abs(edges.determinant());
    for (int k = 0; k < mesh.nodes_per_element(); ++k) {
      sum[mesh.elements(k, e)] += volume * (model.energy.swelling[e] - 1.0);
      weight[mesh.elements(k, e)] += volume;
    }
  }
  return sum.cwiseQuotient(weight);
}

std::string case_cards(const SolverModel& model, const SolverCase& one, const Dialect& dialect) {
  std::string out = head(model);
  fmt::format_to(Out(out), "** load case {} ({})\n*INCLUDE, INPUT=mesh.inp\n", one.name, one.use);
  const bool swells = model.energy.swelling.size() > 0;
  for (const SolverMaterial& m : model.materials)
    out += material_cards(model, m, one.stiffness, dialect);
  out += spring_cards(model, one, 2 * model.mesh().size() + 1);
  if (swells) out += "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL,0.\n";
  const double largest = one.pressures.empty() ? 0.5 : dialect.pressed_step;
  for (size_t s = 0; s < one.shares.size(); ++s) {
    // One Newton tolerance for both programs, far below their standard: residual and correction.
    fmt::format_to(Out(out),
                   "*STEP, NLGEOM, INC=500\n*STATIC\n{},1.,1e-5,{}\n"
                   "*CONTROLS, PARAMETERS=FIELD\n1e-5,1e-4,,,1e-3,1e-8\n",
                   std::min(0.25, largest), largest);
    out += boundary_cards(model, one, one.shares[s]) + load_cards(model, one, one.shares[s]);
    if (swells) {
      const VectorXd strain = one.shares[s] * swelling_at_nodes(model);
      out += "*TEMPERATURE\n";
      for (Eigen::Index n = 0; n < strain.size(); ++n)
        fmt::format_to(Out(out), "{},{}\n", n + 1, number(strain[n]));
    }
    fmt::format_to(Out(out), "*NODE PRINT, NSET=NALL, FREQUENCY=9999\n{}\n{}*END STEP\n",
                   dialect.printed, dialect.results);
  }
  return out;
}

std::vector<std::string> case_lacks(const SolverModel& model, const Dialect& dialect) {
  std::vector<std::string> out;
  for (const SolverCase& one : model.cases) {
    if (!one.floors.empty())
      out.push_back(
          fmt::format("load case {}: the floor that the body may touch is left out", one.name));
    if (!one.foundations.empty())
      out.push_back(
          fmt::format("load case {}: the bed of springs of a soft clamp is lumped into "
                      "springs at the nodes",
                      one.name));
    if (one.strains && !one.free_motions.empty())
      out.push_back(fmt::format("load case {}: no support holds the {}; {} needs one", one.name,
                                fmt::join(one.free_motions, ", the "), dialect.program));
  }
  if (model.energy.swelling.size() > 0)
    out.push_back(
        fmt::format("swelling is a thermal strain at the nodes, where it varies a mean "
                    "over the elements around; {}",
                    dialect.swelling));
  return out;
}

}  // namespace

std::string number(double value) { return fmt::format("{:.12g}", value + 0.0); }

int face_number(const TetMesh& mesh, int face) {
  const int e = mesh.boundary_element[static_cast<size_t>(face)];
  for (int f = 0; f < 4; ++f) {
    int shared = 0;
    for (const int corner : kFaces[f])
      for (int k = 0; k < 3; ++k) shared += mesh.elements(corner, e) == mesh.boundary(k, face);
    if (shared == 3) return f + 1;
  }
  throw std::logic_error("a boundary face is none of its element's");
}

std::vector<std::string> set_names(const SolverModel& model) {
  std::set<std::string> taken = {"NALL", "EALL", "ETWICE"};
  for (const SolverMaterial& m : model.materials) taken.insert({m.name, m.name + "_L"});
  std::vector<std::string> out;
  for (const auto& [name, region] : model.regions) {
    std::string plain;
    for (const char c : name)
      plain += std::isalnum(static_cast<unsigned char>(c))
                   ? static_cast<char>(std::toupper(static_cast<unsigned char>(c)))
                   : '_';
    if (plain.empty() || !std::isalpha(static_cast<unsigned char>(plain[0]))) plain = "R" + plain;
    plain = plain.substr(0, 60);
    std::string unique = plain;
    for (int i = 2; !taken.insert(unique).second; ++i) unique = fmt::format("{}_{}", plain, i);
    out.push_back(unique);
  }
  return out;
}

Exported write(const SolverModel& model, const Dialect& dialect) {
  Exported out;
  out.files.emplace_back("mesh.inp", mesh_cards(model));
  for (const SolverCase& one : model.cases)
    if (one.strains) out.files.emplace_back(one.file + ".inp", case_cards(model, one, dialect));
  out.lacks = material_lacks(model, dialect);
  for (auto& lack : case_lacks(model, dialect)) out.lacks.push_back(std::move(lack));
  return out;
}

}  // namespace hookeye::deck
