// febio: a .feb file (febio_spec 4.0) a load case.
//
// What is written follows FEBio's sources (FEBioXML, FEBioMech, 2026):
// - Mooney-Rivlin, Yeoh and Ogden are uncoupled. Their volumetric energy is that of pressure_model:
//   by default k/2 (log J)^2; `Abaqus` is k/2 (J - 1)^2, Hookeye's own, and is the one written.
//   (FEBio's "neo-Hookean" is coupled: mu/2 (I1 - 3) - mu log J + lambda/2 (log J)^2. Not written.)
// - Ogden: sum c_i/m_i^2 (sum_j lbar_j^m_i - 3): c_i = mu_i alpha_i.
// - tet10 counts mid-edge nodes 12 23 31 14 24 34; TET10G4 is Hookeye's rule of four points.
// - a body force acts against the vector that is written; a pressure pushes inwards.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <iterator>

#include "exporters/deck.h"
#include "exporters/xml_text.h"

namespace hookeye::febio {
namespace {

using Out = std::back_insert_iterator<std::string>;
using deck::number;

std::string tag(const char* name, double value) {
  return fmt::format("\t\t\t<{0}>{1}</{0}>\n", name, number(value));
}

/// Isotropic moduli (lambda, mu) nearest to C.
std::pair<double, double> isotropic(const Stiffness6& C) {
  const double volume = C.topLeftCorner<3, 3>().sum();
  const double all = C.diagonal().head<3>().sum() + 2 * C.diagonal().tail<3>().sum();
  const double mu = (3 * all - volume) / 30;
  return {volume / 9 - 2 * mu / 3, mu};
}

bool is_isotropic(const Stiffness6& C) {
  const auto [lambda, mu] = isotropic(C);
  Stiffness6 same = Stiffness6::Zero();
  same.topLeftCorner<3, 3>().setConstant(lambda);
  same.diagonal().head<3>().array() += 2 * mu;
  same.diagonal().tail<3>().setConstant(mu);
  return (C - same).norm() <= 1e-9 * C.norm();
}

/// Powers of I1bar beside I2bar or powers of stretches are in no law of FEBio's.
bool fits(const Rubber& r) {
  const bool powers = r.c20 != 0 || r.c30 != 0;
  return !(powers && (r.c01 != 0 || !r.ogden.empty())) && r.as_ogden().size() <= 6;
}

std::string rubber(const Rubber& r, double density, const std::string& name, int id) {
  std::string law = "Mooney-Rivlin", values;
  if (!fits(r)) {
    values = tag("c1", 0.5 * r.mu()) + tag("c2", 0);
  } else if (!r.ogden.empty()) {
    law = "Ogden";
    int k = 0;
    for (const auto& [mu, alpha] : r.as_ogden()) {
      ++k;
      values += tag(fmt::format("c{}", k).c_str(), mu * alpha) +
                tag(fmt::format("m{}", k).c_str(), alpha);
    }
  } else if (r.c20 != 0 || r.c30 != 0) {
    law = "Yeoh";
    values = tag("c1", r.c10) + tag("c2", r.c20) + tag("c3", r.c30);
  } else {
    values = tag("c1", r.c10) + tag("c2", r.c01);
  }
  return fmt::format("\t\t<material id=\"{}\" name=\"{}\" type=\"{}\">\n{}{}{}", id, name, law,
                     tag("density", density), values, tag("k", r.some_kappa())) +
         "\t\t\t<pressure_model>Abaqus</pressure_model>\n\t\t</material>\n";
}

std::string linear(const Stiffness6& C, double density, const std::string& name, int id) {
  const auto [lambda, mu] = isotropic(C);
  return fmt::format("\t\t<material id=\"{}\" name=\"{}\" type=\"St.Venant-Kirchhoff\">\n{}{}{}",
                     id, name, tag("density", density),
                     tag("E", mu * (3 * lambda + 2 * mu) / (lambda + mu)),
                     tag("v", lambda / (2 * (lambda + mu)))) +
         "\t\t</material>\n";
}

/// What a domain is made of; parts of a sum are domains at the same nodes.
struct Domain {
  const SolverMaterial* material;
  bool linear;
  std::string name;
};

std::vector<Domain> domains(const SolverModel& model) {
  std::vector<Domain> out;
  for (const SolverMaterial& m : model.materials) {
    if (!m.rubber.none()) out.push_back({&m, false, m.name});
    if (!m.linear.isZero(0.0)) out.push_back({&m, true, m.name + "_L"});
  }
  return out;
}

std::string materials(const SolverModel& model, double factor) {
  std::string out = "\t<Material>\n";
  int id = 0;
  for (const Domain& d : domains(model)) {
    const double density = d.linear && deck::has_both(*d.material) ? 0.0 : model.density;
    ++id;
    out += d.linear ? linear(d.material->linear * factor, density, d.name, id)
                    : rubber(d.material->rubber.scaled(factor), density, d.name, id);
  }
  return out + "\t</Material>\n";
}

/// Displacements and forces of one component: the nodes with their values.
struct NodalField {
  std::string name;
  int component;
  std::vector<int> nodes;
  std::vector<double> values;
};

/// Everything about one load case that more than one section tells.
struct Case {
  std::vector<NodalField> fixed;               ///< without values
  std::vector<std::vector<NodalField>> moved;  ///< by step: on top of the step before
  std::vector<NodalField> forces;
  std::map<int, double> pressure;  ///< by column of the boundary
};

Case case_of(const SolverModel& model, const SolverCase& one) {
  Case out;
  const Loading held = clamped(model, one);
  const auto& X = model.mesh().X;
  out.moved.resize(one.shares.size());
  for (int c = 0; c < 3; ++c) {
    const char axis = "xyz"[c];
    NodalField fixed{fmt::format("fixed_{}", axis), c, {}, {}};
    std::vector<size_t> moving;
    for (size_t i = 0; i < held.prescribed.size(); ++i) {
      if (held.prescribed[i] % 3 != c) continue;
      const bool stands = std::all_of(one.shares.begin(), one.shares.end(), [&](double share) {
        return held.displacement_at(X, i, share) == 0.0;
      });
      if (stands)
        fixed.nodes.push_back(held.prescribed[i] / 3);
      else
        moving.push_back(i);
    }
    if (!fixed.nodes.empty()) out.fixed.push_back(fixed);
    for (size_t s = 0; s < one.shares.size() && !moving.empty(); ++s) {
      NodalField step{fmt::format("moved_{}_{}", axis, s + 1), c, {}, {}};
      for (const size_t i : moving) {
        const double before = s == 0 ? 0.0 : held.displacement_at(X, i, one.shares[s - 1]);
        step.nodes.push_back(held.prescribed[i] / 3);
        step.values.push_back(held.displacement_at(X, i, one.shares[s]) - before);
      }
      out.moved[s].push_back(step);
    }
    NodalField force{fmt::format("force_{}", axis), c, {}, {}};
    for (int n = 0; n < model.mesh().nodes(); ++n)
      if (const double f = one.nodal_force[3 * n + c]; f != 0.0) {
        force.nodes.push_back(n);
        force.values.push_back(f);
      }
    if (!force.nodes.empty()) out.forces.push_back(force);
  }
  for (const PressureOn& p : one.pressures)
    for (const auto& [face, fraction] : p.faces) out.pressure[face] += fraction * p.pressure;
  return out;
}

std::vector<const NodalField*> all_fields(const Case& c) {
  std::vector<const NodalField*> out;
  for (const NodalField& f : c.fixed) out.push_back(&f);
  for (const auto& step : c.moved)
    for (const NodalField& f : step) out.push_back(&f);
  for (const NodalField& f : c.forces) out.push_back(&f);
  return out;
}

void node_set(const std::string& name, const std::vector<int>& nodes, std::string& out) {
  fmt::format_to(Out(out), "\t\t<NodeSet name=\"{}\">", name);
  for (size_t i = 0; i < nodes.size(); ++i)
    fmt::format_to(Out(out), "{}{}", i ? "," : "", nodes[i] + 1);
  out += "</NodeSet>\n";
}

std::string mesh(const SolverModel& model, const Case& c) {
  const TetMesh& mesh = model.mesh();
  std::string out = "\t<Mesh>\n\t\t<Nodes name=\"body\">\n";
  for (int n = 0; n < mesh.nodes(); ++n)
    fmt::format_to(Out(out), "\t\t\t<node id=\"{}\">{},{},{}</node>\n", n + 1, number(mesh.X(0, n)),
                   number(mesh.X(1, n)), number(mesh.X(2, n)));
  out += "\t\t</Nodes>\n";
  int id = 0;
  for (const Domain& d : domains(model)) {
    fmt::format_to(Out(out), "\t\t<Elements type=\"{}\" name=\"{}\">\n",
                   mesh.order == 1 ? "tet4" : "tet10", d.name);
    for (const int e : d.material->elements) {
      fmt::format_to(Out(out), "\t\t\t<elem id=\"{}\">", ++id);
      for (int k = 0; k < mesh.nodes_per_element(); ++k)
        fmt::format_to(Out(out), "{}{}", k ? "," : "", mesh.elements(deck::kOrder[k], e) + 1);
      out += "</elem>\n";
    }
    out += "\t\t</Elements>\n";
  }
  const auto names = deck::set_names(model);
  for (size_t r = 0; r < names.size(); ++r) node_set(names[r], model.regions[r].second->nodes, out);
  for (const NodalField* f : all_fields(c)) node_set(f->name, f->nodes, out);
  if (!c.pressure.empty()) {
    out += "\t\t<Surface name=\"pressed\">\n";
    int face = 0;
    for (const auto& [column, p] : c.pressure) {
      const Eigen::VectorXi nodes = mesh.boundary.col(column).array() + 1;
      fmt::format_to(Out(out), "\t\t\t<tri{0} id=\"{1}\">{2}</tri{0}>\n", nodes.size(), ++face,
                     fmt::join(nodes.data(), nodes.data() + nodes.size(), ","));
    }
    out += "\t\t</Surface>\n";
  }
  out += "\t</Mesh>\n\t<MeshDomains>\n";
  for (const Domain& d : domains(model))
    fmt::format_to(Out(out), "\t\t<SolidDomain name=\"{0}\" mat=\"{0}\"{1}/>\n", d.name,
                   mesh.order == 1 ? "" : " elem_type=\"TET10G4\"");
  return out + "\t</MeshDomains>\n";
}

std::string mesh_data(const Case& c) {
  std::string out = "\t<MeshData>\n";
  for (const NodalField* f : all_fields(c)) {
    if (f->values.empty()) continue;
    fmt::format_to(Out(out),
                   "\t\t<NodeData name=\"{0}_values\" node_set=\"{0}\" data_type=\"scalar\">\n",
                   f->name);
    for (size_t i = 0; i < f->values.size(); ++i)
      fmt::format_to(Out(out), "\t\t\t<node lid=\"{}\">{}</node>\n", i + 1, number(f->values[i]));
    out += "\t\t</NodeData>\n";
  }
  if (!c.pressure.empty()) {
    out += "\t\t<SurfaceData name=\"pressures\" surface=\"pressed\" data_type=\"scalar\">\n";
    int face = 0;
    for (const auto& [column, p] : c.pressure)
      fmt::format_to(Out(out), "\t\t\t<face lid=\"{}\">{}</face>\n", ++face, number(p));
    out += "\t\t</SurfaceData>\n";
  }
  return out + "\t</MeshData>\n";
}

std::string loads(const SolverCase& one, const Case& c) {
  std::string out = "\t<Loads>\n";
  for (const NodalField& f : c.forces)
    fmt::format_to(Out(out),
                   "\t\t<nodal_load name=\"{0}\" type=\"nodal_load\" node_set=\"{0}\">\n"
                   "\t\t\t<dof>{1}</dof>\n\t\t\t<scale lc=\"1\" type=\"map\">{0}_values</scale>\n"
                   "\t\t</nodal_load>\n",
                   f.name, "xyz"[f.component]);
  if (!c.pressure.empty())
    out +=
        "\t\t<surface_load name=\"pressure\" type=\"pressure\" surface=\"pressed\">\n"
        "\t\t\t<pressure lc=\"1\" type=\"map\">pressures</pressure>\n"
        "\t\t\t<symmetric_stiffness>0</symmetric_stiffness>\n\t\t</surface_load>\n";
  if (!one.gravity.isZero(0.0))
    fmt::format_to(Out(out),
                   "\t\t<!-- FEBio's body force acts against this vector -->\n"
                   "\t\t<body_load name=\"gravity\" type=\"body force\">\n"
                   "\t\t\t<force lc=\"1\">{},{},{}</force>\n\t\t</body_load>\n",
                   number(-one.gravity.x()), number(-one.gravity.y()), number(-one.gravity.z()));
  return out + "\t</Loads>\n";
}

std::string steps(const SolverCase& one, const Case& c) {
  std::string out = "\t<Step>\n";
  for (size_t s = 0; s < one.shares.size(); ++s) {
    fmt::format_to(Out(out),
                   "\t\t<step id=\"{0}\" name=\"step{0}\">\n\t\t\t<Control>\n"
                   "\t\t\t\t<analysis>STATIC</analysis>\n\t\t\t\t<time_steps>10</time_steps>\n"
                   "\t\t\t\t<step_size>0.1</step_size>\n"
                   "\t\t\t\t<solver type=\"solid\">\n\t\t\t\t\t<symmetric_stiffness>{1}"
                   "</symmetric_stiffness>\n\t\t\t\t\t<dtol>1e-6</dtol>\n"
                   "\t\t\t\t\t<etol>1e-9</etol>\n\t\t\t\t\t<rtol>1e-9</rtol>\n"
                   "\t\t\t\t</solver>\n\t\t\t</Control>\n",
                   s + 1, c.pressure.empty() ? "symmetric" : "non-symmetric");
    if (!c.moved[s].empty()) out += "\t\t\t<Boundary>\n";
    for (const NodalField& f : c.moved[s])
      fmt::format_to(Out(out),
                     "\t\t\t\t<bc name=\"{0}\" type=\"prescribed displacement\" "
                     "node_set=\"{0}\">\n\t\t\t\t\t<dof>{1}</dof>\n"
                     "\t\t\t\t\t<value lc=\"{2}\" type=\"map\">{0}_values</value>\n"
                     "\t\t\t\t\t<relative>{3}</relative>\n\t\t\t\t</bc>\n",
                     f.name, "xyz"[f.component], s + 2, s == 0 ? 0 : 1);
    if (!c.moved[s].empty()) out += "\t\t\t</Boundary>\n";
    out += "\t\t</step>\n";
  }
  return out + "\t</Step>\n";
}

/// Curve 1: all loads over all steps. Curve k + 1: what step k moves.
std::string load_curves(const SolverCase& one) {
  const auto curve = [](size_t id, double from, double to) {
    return fmt::format(
        "\t\t<load_controller id=\"{}\" type=\"loadcurve\">\n"
        "\t\t\t<interpolate>LINEAR</interpolate>\n\t\t\t<extend>CONSTANT</extend>\n"
        "\t\t\t<points>\n\t\t\t\t<pt>{},0</pt>\n\t\t\t\t<pt>{},1</pt>\n\t\t\t</points>\n"
        "\t\t</load_controller>\n",
        id, from, to);
  };
  const double end = static_cast<double>(one.shares.size());
  std::string out = "\t<LoadData>\n" + curve(1, 0.0, end);
  for (size_t s = 0; s < one.shares.size(); ++s)
    out += curve(s + 2, static_cast<double>(s), static_cast<double>(s + 1));
  return out + "\t</LoadData>\n";
}

std::string document(const SolverModel& model, const SolverCase& one) {
  const Case c = case_of(model, one);
  std::string out = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<febio_spec version=\"4.0\">\n"
      "\t<!-- {}, load case {}; step {} of a run of hookeye; units {}, {}, {}, s -->\n"
      "\t<Module type=\"solid\"/>\n",
      xml_comment(model.title), xml_comment(one.name), xml_comment(model.step), model.units.length,
      model.units.force, model.units.stress());
  out += materials(model, one.stiffness) + mesh(model, c) + mesh_data(c) + "\t<Boundary>\n";
  for (const NodalField& f : c.fixed)
    fmt::format_to(Out(out),
                   "\t\t<bc name=\"{0}\" type=\"zero displacement\" node_set=\"{0}\">\n"
                   "\t\t\t<{1}_dof>1</{1}_dof>\n\t\t</bc>\n",
                   f.name, "xyz"[f.component]);
  out += "\t</Boundary>\n" + loads(one, c) + steps(one, c) + load_curves(one);
  return out +
         "\t<Output>\n\t\t<plotfile type=\"febio\">\n\t\t\t<var type=\"displacement\"/>\n"
         "\t\t\t<var type=\"stress\"/>\n\t\t</plotfile>\n\t\t<logfile>\n"
         "\t\t\t<node_data data=\"ux;uy;uz\" delim=\",\"/>\n\t\t</logfile>\n\t</Output>\n"
         "</febio_spec>\n";
}

class FEBio final : public Exporter {
 public:
  std::string name() const override { return "febio"; }
  std::string title() const override { return "a FEBio file (febio_spec 4.0) a load case"; }
  Exported write(const SolverModel& model) const override {
    Exported out;
    for (const SolverCase& one : model.cases)
      if (one.strains) out.files.emplace_back(one.file + ".feb", document(model, one));
    bool unfit = false, turned = false;
    for (const SolverMaterial& m : model.materials) {
      unfit |= !m.rubber.none() && !fits(m.rubber);
      turned |= !m.linear.isZero(0.0) && !is_isotropic(m.linear);
    }
    if (unfit)
      out.lacks.push_back(
          "powers of I1bar beside I2bar or powers of the stretches are in no law of FEBio's: they "
          "are replaced by neo-Hooke of the shear modulus at rest");
    if (turned)
      out.lacks.push_back(
          "a stiffness with directions is replaced by the isotropic one nearest to it");
    if (model.energy.swelling.size() > 0) out.lacks.push_back("swelling is left out");
    add_case_lacks(model, "FEBio", out.lacks);
    out.notes = {
        "febio4 -i CASE.feb. Written from FEBio's sources and not run in it by the "
        "authors of this export.",
        "pressure_model is Abaqus: the volumetric energy is Hookeye's, k/2 (J - 1)^2. "
        "FEBio's standard, k/2 (log J)^2, is another."};
    return out;
  }
};

}  // namespace
}  // namespace hookeye::febio

HOOKEYE_DEFINE_EXPORTER(febio, febio::FEBio)
