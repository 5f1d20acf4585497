// sofa: a SOFA scene (.scn) a load case, solved as a static problem.
//
// What is written follows SOFA's sources and example scenes (2026):
// - TetrahedronHyperelasticityFEMForceField, MooneyRivlin: c1 (I1bar - 3) + c2 (I2bar - 3) + k0/2
//   (log J)^2. The volumetric energy is not Hookeye's k/2 (J - 1)^2: by how much is told.
//   (SOFA's NeoHookean is coupled. Not written.) StVenantKirchhoff: mu, lambda.
// - tetrahedra are linear. A quadratic one is written as eight at the same nodes.
// - SurfacePressureForceField pushes along the normal of the triangles: the pressure is negative.
// - displacements of the supports rise over a second, in ten steps; loads act from the beginning.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <iterator>

#include "exporters/deck.h"
#include "exporters/xml_text.h"

namespace hookeye::sofa {
namespace {

using Out = std::back_insert_iterator<std::string>;
using deck::number;

constexpr const char* kPlugins[] = {"Sofa.Component.AnimationLoop",
                                    "Sofa.Component.Constraint.Projective",
                                    "Sofa.Component.LinearSolver.Direct",
                                    "Sofa.Component.Mass",
                                    "Sofa.Component.MechanicalLoad",
                                    "Sofa.Component.ODESolver.Backward",
                                    "Sofa.Component.SolidMechanics.FEM.HyperElastic",
                                    "Sofa.Component.StateContainer",
                                    "Sofa.Component.Topology.Container.Dynamic",
                                    "Sofa.Component.Visual"};

/// The corners' four and, of a quadratic one, four of the octahedron within: of equal orientation.
/// Middle nodes as in TetMesh: 4 on 01, 5 on 12, 6 on 02, 7 on 03, 8 on 23, 9 on 13.
constexpr int kEight[8][4] = {{0, 4, 6, 7}, {4, 1, 5, 9}, {6, 5, 2, 8}, {7, 9, 8, 3},
                              {4, 5, 6, 7}, {4, 9, 5, 7}, {5, 9, 8, 7}, {5, 8, 6, 7}};
constexpr int kFour[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};

void tetrahedra(const TetMesh& mesh, const std::vector<int>& elements, std::string& out) {
  for (const int e : elements)
    for (int t = 0; t < (mesh.order == 1 ? 1 : 8); ++t)
      for (int k = 0; k < 4; ++k)
        fmt::format_to(Out(out), "{} ", mesh.elements(mesh.order == 1 ? k : kEight[t][k], e));
}

/// Powers of I1bar, and of the stretches, are not in MooneyRivlin.
bool fits(const Rubber& r) { return r.c20 == 0 && r.c30 == 0 && r.ogden.empty(); }

std::string force_field(const std::string& material, const std::vector<double>& values) {
  std::string set;
  for (const double v : values) {
    if (!set.empty()) set += ' ';
    set += number(v);
  }
  return fmt::format(
      "      <TetrahedronHyperelasticityFEMForceField materialName=\"{}\" ParameterSet=\"{}\"/>\n",
      material, set);
}

std::string materials(const SolverModel& model, double factor) {
  std::string out;
  for (const SolverMaterial& m : model.materials) {
    const Rubber r = m.rubber.scaled(factor);
    std::string fields;
    if (!r.none())
      fields += force_field(
          "MooneyRivlin", {fits(r) ? r.c10 : 0.5 * r.mu(), fits(r) ? r.c01 : 0.0, r.some_kappa()});
    if (!m.linear.isZero(0.0)) {
      const Stiffness6 C = m.linear * factor;
      const double volume = C.topLeftCorner<3, 3>().sum();
      const double all = C.diagonal().head<3>().sum() + 2 * C.diagonal().tail<3>().sum();
      const double mu = (3 * all - volume) / 30;
      fields += force_field("StVenantKirchhoff", {mu, volume / 9 - 2 * mu / 3});
    }
    fmt::format_to(Out(out),
                   "    <Node name=\"{}\">\n      <TetrahedronSetTopologyContainer "
                   "position=\"@../positions.position\" tetrahedra=\"",
                   m.name);
    tetrahedra(model.mesh(), m.elements, out);
    fmt::format_to(Out(out), "\"/>\n{}    </Node>\n", fields);
  }
  return out;
}

/// One constraint a node and set of components that move alike, or one for all that stand.
std::string supports(const SolverModel& model, const SolverCase& one) {
  const Loading held = clamped(model, one);
  struct Node {
    std::array<int, 3> directions{};
    std::vector<Vector3d> moves;  ///< at each share of the load
  };
  std::map<int, Node> nodes;
  for (size_t i = 0; i < held.prescribed.size(); ++i) {
    Node& node = nodes[held.prescribed[i] / 3];
    node.moves.resize(one.shares.size(), Vector3d::Zero());
    const int c = held.prescribed[i] % 3;
    node.directions[static_cast<size_t>(c)] = 1;
    for (size_t s = 0; s < one.shares.size(); ++s)
      node.moves[s][c] = held.displacement_at(model.mesh().X, i, one.shares[s]);
  }
  std::map<std::string, std::vector<int>> alike;  // of what follows the indices
  for (const auto& [n, node] : nodes) {
    std::string moves = "0 0 0", times = "0";
    for (size_t s = 0; s < one.shares.size(); ++s) {
      moves += fmt::format(" {} {} {}", number(node.moves[s].x()), number(node.moves[s].y()),
                           number(node.moves[s].z()));
      times += fmt::format(" {}", number(one.shares[s]));
    }
    alike[fmt::format("movedDirections=\"{}\" keyTimes=\"{}\" movements=\"{}\"",
                      fmt::join(node.directions, " "), times, moves)]
        .push_back(n);
  }
  std::string out;
  for (const auto& [motion, indices] : alike)
    fmt::format_to(Out(out), "    <PartialLinearMovementProjectiveConstraint indices=\"{}\" {}/>\n",
                   fmt::join(indices, " "), motion);
  return out;
}

std::string loads(const SolverModel& model, const SolverCase& one) {
  const TetMesh& mesh = model.mesh();
  std::string out, indices, forces;
  for (int n = 0; n < mesh.nodes(); ++n) {
    const Vector3d f = one.nodal_force.segment<3>(3 * n);
    if (f.isZero(0.0)) continue;
    fmt::format_to(Out(indices), "{} ", n);
    fmt::format_to(Out(forces), "{} {} {} ", number(f.x()), number(f.y()), number(f.z()));
  }
  if (!indices.empty())
    fmt::format_to(Out(out), "    <ConstantForceField indices=\"{}\" forces=\"{}\"/>\n", indices,
                   forces);
  std::map<double, std::vector<int>> pressed;  // faces by pressure
  std::map<int, double> pressure;
  for (const PressureOn& p : one.pressures)
    for (const auto& [face, fraction] : p.faces) pressure[face] += fraction * p.pressure;
  for (const auto& [face, p] : pressure) pressed[p].push_back(face);
  for (const auto& [p, faces] : pressed) {
    out +=
        "    <Node>\n      <TriangleSetTopologyContainer position=\"@../positions.position\" "
        "triangles=\"";
    for (const int face : faces)
      for (int t = 0; t < (mesh.order == 1 ? 1 : 4); ++t)
        for (int k = 0; k < 3; ++k)
          fmt::format_to(Out(out), "{} ", mesh.boundary(mesh.order == 1 ? k : kFour[t][k], face));
    fmt::format_to(Out(out),
                   "\"/>\n      <SurfacePressureForceField pressure=\"{}\"/>\n    "
                   "</Node>\n",
                   number(-p));
  }
  return out;
}

std::string document(const SolverModel& model, const SolverCase& one) {
  const TetMesh& mesh = model.mesh();
  std::string out = fmt::format(
      "<?xml version=\"1.0\"?>\n<!-- {}, load case {}; step {} of a run of hookeye; units {}, {}, "
      "{}, s -->\n<Node name=\"root\" dt=\"0.1\" gravity=\"{} {} {}\">\n",
      xml_comment(model.title), xml_comment(one.name), xml_comment(model.step), model.units.length,
      model.units.force, model.units.stress(), number(one.gravity.x()), number(one.gravity.y()),
      number(one.gravity.z()));
  for (const char* plugin : kPlugins)
    fmt::format_to(Out(out), "  <RequiredPlugin name=\"{}\"/>\n", plugin);
  out +=
      "  <DefaultAnimationLoop/>\n  <VisualStyle displayFlags=\"showBehaviorModels "
      "showForceFields\"/>\n  <Node name=\"body\">\n"
      "    <NewtonRaphsonSolver name=\"newton\" maxNbIterationsNewton=\"100\" "
      "maxNbIterationsLineSearch=\"10\"/>\n    <StaticSolver newtonSolver=\"@newton\"/>\n"
      "    <EigenSimplicialLDLT template=\"CompressedRowSparseMatrixMat3x3\"/>\n"
      "    <TetrahedronSetTopologyContainer name=\"positions\" position=\"";
  for (int n = 0; n < mesh.nodes(); ++n)
    fmt::format_to(Out(out), "{} {} {} ", number(mesh.X(0, n)), number(mesh.X(1, n)),
                   number(mesh.X(2, n)));
  out += "\" tetrahedra=\"";
  std::vector<int> all(static_cast<size_t>(mesh.size()));
  for (int e = 0; e < mesh.size(); ++e) all[static_cast<size_t>(e)] = e;
  tetrahedra(mesh, all, out);
  fmt::format_to(Out(out),
                 "\"/>\n    <TetrahedronSetGeometryAlgorithms template=\"Vec3\"/>\n"
                 "    <MechanicalObject template=\"Vec3\" name=\"state\"/>\n"
                 "    <MeshMatrixMass massDensity=\"{}\"/>\n",
                 number(model.density));
  out += materials(model, one.stiffness) + supports(model, one) + loads(model, one);
  return out + "  </Node>\n</Node>\n";
}

class Sofa final : public Exporter {
 public:
  std::string name() const override { return "sofa"; }
  std::string title() const override { return "a SOFA scene a load case"; }
  Exported write(const SolverModel& model) const override {
    Exported out;
    bool unfit = false, directions = false;
    for (const SolverMaterial& m : model.materials) {
      unfit |= !fits(m.rubber);
      directions |= !m.linear.isZero(0.0);
    }
    for (const SolverCase& one : model.cases)
      if (one.strains) out.files.emplace_back(one.file + ".scn", document(model, one));
    std::string volume = "SOFA's volumetric energy is k/2 (log J)^2, not k/2 (J - 1)^2";
    if (const auto off = logarithm_difference(model))
      volume += fmt::format(": at the volume ratios found its pressure differs by up to {:.2g} %",
                            100 * *off);
    out.lacks.push_back(volume);
    if (model.mesh().order == 2)
      out.lacks.push_back(
          "SOFA's tetrahedra are linear: each is written as eight at the same "
          "nodes, which bend more stiffly");
    if (unfit)
      out.lacks.push_back(
          "powers of I1bar or of the stretches are replaced by neo-Hooke of the "
          "shear modulus at rest");
    if (directions)
      out.lacks.push_back(
          "stiffnesses of the Green strain are replaced by the isotropic ones nearest to them");
    if (model.energy.swelling.size() > 0) out.lacks.push_back("swelling is left out");
    add_case_lacks(model, "SOFA", out.lacks);
    out.notes = {
        "runSofa CASE.scn, ten steps of animation. Written from SOFA's sources and not run "
        "in it by the authors of this export.",
        "Supports move over the ten steps; forces, pressure and weight act from the first "
        "step on."};
    return out;
  }
};

}  // namespace
}  // namespace hookeye::sofa

HOOKEYE_DEFINE_EXPORTER(sofa, sofa::Sofa)
