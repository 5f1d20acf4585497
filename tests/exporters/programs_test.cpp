// FEBio, PolyFEM and SOFA are not here: structure, numbers and node orders of what is written.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "core/xml_file.h"
#include "exporters/block.h"
#include "exporters/patches.h"

namespace hookeye::test {
namespace {

using nlohmann::json;

/// Numbers between blanks and commas.
std::vector<double> numbers_in(std::string_view text) {
  std::vector<double> out;
  std::string plain(text);
  std::replace(plain.begin(), plain.end(), ',', ' ');
  std::istringstream words(plain);
  for (double x = 0; words >> x;) out.push_back(x);
  return out;
}

/// The block with a weight and a pressure, and what each load case of it comes to.
class Programs : public testing::Test {
 protected:
  Model loaded() const {
    Model model = block_.model();
    model.gravity = Vector3d(0, 0, -9810);
    const auto weight = self_weight(block_.mesh(), 1.07e-9, model.gravity);
    for (auto& example : model.examples) {
      example.loading.forces.push_back(weight);
      example.loading.forces.push_back(follower_pressure(block_.region("grip"), 0.01));
    }
    return model;
  }
  Exported exported(const Model& model, const std::string& to) const {
    return export_model(*find_exporter(to), solver_model(model));
  }
  const Block block_;
};

TEST_F(Programs, FEBioHasNodesElementsAndLoads) {
  const Exported out = exported(loaded(), "febio");
  const XmlFile file(file_of(out, "twist.feb"), "twist.feb", "xml");
  const XmlNode top = file.child("febio_spec");
  EXPECT_EQ(top.attribute("version"), "4.0");
  const auto nodes = top.child("Mesh").child("Nodes").all("node");
  ASSERT_EQ(nodes.size(), static_cast<size_t>(block_.mesh().nodes()));
  const auto at = [&](double id) {
    const auto x = numbers_in(nodes.at(static_cast<size_t>(id) - 1).text());
    return Vector3d(x.at(0), x.at(1), x.at(2));
  };
  // FECore, FETet10::shape_fnc: mid nodes on 12 23 31 14 24 34.
  const int edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  const auto elements = top.child("Mesh").child("Elements").all("elem");
  ASSERT_EQ(elements.size(), static_cast<size_t>(block_.mesh().size()));
  for (const XmlNode& e : elements) {
    const auto n = numbers_in(e.text());
    ASSERT_EQ(n.size(), 10u);
    for (int k = 0; k < 6; ++k) {
      const Vector3d middle = at(n[static_cast<size_t>(4 + k)]);
      const Vector3d a = at(n[static_cast<size_t>(edges[k][0])]);
      const Vector3d b = at(n[static_cast<size_t>(edges[k][1])]);
      EXPECT_LT((middle - 0.5 * (a + b)).norm(), 1e-9);
    }
  }
  const XmlNode material = top.child("Material").child("material");
  EXPECT_EQ(material.attribute("type"), "Mooney-Rivlin");
  EXPECT_EQ(material.child("c1").text(), "0.025");
  EXPECT_EQ(material.child("k").text(), "0.5");
  EXPECT_EQ(material.child("pressure_model").text(), "Abaqus");
  // The body force of FEBio acts against the vector that is written.
  EXPECT_EQ(top.child("Loads").child("body_load").child("force").text(), "0,0,9810");
  // Every name that is used is there, and full.
  for (const XmlNode& set : top.child("Mesh").all("NodeSet")) {
    const auto n = numbers_in(set.text());
    ASSERT_FALSE(n.empty()) << set.attribute("name");
    for (const double id : n) EXPECT_TRUE(id >= 1 && id <= block_.mesh().nodes());
  }
  size_t moved = 0;
  for (const XmlNode& bc : top.all("bc")) {
    const std::string name(bc.attribute("node_set"));
    EXPECT_TRUE(top.child("Mesh").child("NodeSet", "name", name)) << name;
    if (bc.attribute("type") != "prescribed displacement") continue;
    ++moved;
    const std::string map(bc.child("value").text());
    const XmlNode data = top.child("MeshData").child("NodeData", "name", map);
    ASSERT_TRUE(data) << map;
    EXPECT_EQ(data.all("node").size(),
              numbers_in(top.child("Mesh").child("NodeSet", "name", name).text()).size());
  }
  EXPECT_EQ(moved, 3u);
  EXPECT_EQ(top.child("MeshDomains").child("SolidDomain").attribute("elem_type"), "TET10G4");
}

/// By steps: what is moved sums to the whole, each on top of the step before.
TEST_F(Programs, FEBioTurnsInSteps) {
  Model model = loaded();
  const int e = model.scene->example_index("twist");
  model.examples[static_cast<size_t>(e)].loading.prescribe_rigid(
      block_.mesh(), block_.region("grip"),
      {Vector3d::UnitZ(), 100.0, Vector3d(0, 0, 40), Vector3d::Zero()});
  const Exported out = exported(model, "febio");
  const XmlFile file(file_of(out, "twist.feb"), "twist.feb", "xml");
  const XmlNode top = file.child("febio_spec");
  EXPECT_EQ(top.child("Step").all("step").size(), 4u);
  Vector3d sum = Vector3d::Zero();
  const int node = block_.region("grip").nodes.front();
  for (const XmlNode& data : top.child("MeshData").all("NodeData")) {
    const std::string name(data.attribute("node_set"));
    if (!name.starts_with("moved_")) continue;
    const auto set = numbers_in(top.child("Mesh").child("NodeSet", "name", name).text());
    const auto values = data.all("node");
    for (size_t i = 0; i < set.size(); ++i)
      if (static_cast<int>(set[i]) == node + 1)
        sum[name[6] - 'x'] += numbers_in(values.at(i).text()).at(0);
  }
  const Vector3d X = block_.mesh().X.col(node);
  const RigidMotion turn{Vector3d::UnitZ(), 100.0, Vector3d(0, 0, 40), Vector3d::Zero()};
  EXPECT_LT((sum - (turn.apply(X) - X)).norm(), 1e-9);
}

TEST_F(Programs, PolyFEMHasFacesAndConditions) {
  const Exported out = exported(loaded(), "polyfem");
  const json document = json::parse(file_of(out, "pull.json"));
  EXPECT_EQ(document["space"]["discr_order"], 2);
  EXPECT_EQ(document["geometry"][0]["mesh"], "mesh.msh");
  EXPECT_EQ(document["geometry"][0]["surface_selection"], "faces.txt");
  const json& material = document["materials"][0];
  EXPECT_EQ(material["type"], "MooneyRivlin3Param");
  EXPECT_EQ(material["c1"], 0.025);
  EXPECT_EQ(material["d1"], 0.25);
  EXPECT_EQ(document["boundary_conditions"]["rhs"][2], "9810*t");  // the body falls against it

  std::istringstream mesh(file_of(out, "mesh.msh"));
  std::string line;
  while (std::getline(mesh, line) && line != "$Nodes") {
  }
  size_t count = 0;
  mesh >> count;
  Matrix3Xd X(3, static_cast<Eigen::Index>(count));
  for (Eigen::Index i = 0; i < X.cols(); ++i) {
    int id = 0;
    mesh >> id >> X(0, i) >> X(1, i) >> X(2, i);
    ASSERT_EQ(id, i + 1);
  }
  // Total force of each traction, by the faces of its id.
  std::map<int, double> area;
  std::istringstream faces(file_of(out, "faces.txt"));
  for (int id = 0, a = 0, b = 0, c = 0; faces >> id >> a >> b >> c;) {
    const Vector3d side = X.col(b) - X.col(a), other = X.col(c) - X.col(a);
    area[id] += 0.5 * side.cross(other).norm();
  }
  Vector3d force = Vector3d::Zero();
  for (const json& one : document["boundary_conditions"]["neumann_boundary"])
    for (int i = 0; i < 3; ++i)
      force[i] +=
          area.at(one["id"]) * std::stod(one["value"][static_cast<size_t>(i)].get<std::string>());
  EXPECT_LT((force - Vector3d(0.3, 0.1, 4.0)).norm(), 1e-9);
  double pressed = 0;
  for (const json& one : document["boundary_conditions"]["pressure_boundary"])
    pressed += area.at(one["id"]) * std::stod(one["value"].get<std::string>());
  EXPECT_NEAR(pressed, 0.01 * block_.region("grip").area, 1e-9);
  ASSERT_EQ(document["boundary_conditions"]["dirichlet_boundary"].size(), 1u);
  EXPECT_EQ(document["boundary_conditions"]["dirichlet_boundary"][0]["dimension"],
            json::array({true, true, true}));
  EXPECT_FALSE(mentions(out.lacks, "left out"));
}

/// Value of "sin(a*t)*(..)+(1-cos(a*t))*(..)+t*(..)" or "t*(..)" as the exporter writes them.
double value_of(const std::string& expression, const Vector3d& x, double t) {
  const auto form = [&](const std::string& text, size_t open) {
    double a = 0, b = 0, c = 0, d = 0;
    EXPECT_EQ(std::sscanf(text.c_str() + open, "(%lf*x+%lf*y+%lf*z+%lf)", &a, &b, &c, &d), 4)
        << text;
    return a * x.x() + b * x.y() + c * x.z() + d;
  };
  if (expression.starts_with("t*")) return t * form(expression, 2);
  const double angle = std::stod(expression.substr(4)) * t;
  const size_t first = expression.find(")*(") + 2;
  const size_t second = expression.find("))*(") + 3, third = expression.find("+t*(") + 3;
  return std::sin(angle) * form(expression, first) +
         (1 - std::cos(angle)) * form(expression, second) + t * form(expression, third);
}

TEST_F(Programs, PolyFEMTurnsByTheAngle) {
  Model model = block_.model();
  const int e = model.scene->example_index("twist");
  const RigidMotion turn{Vector3d(1, 2, 2) / 3, 140.0, Vector3d(3, 1, 40), Vector3d(0.5, 0, 2)};
  auto& loading = model.examples[static_cast<size_t>(e)].loading;
  loading.prescribe_rigid(block_.mesh(), block_.region("grip"), turn);
  const SolverModel solver = solver_model(model);
  const Patches patches = patches_of(solver);
  EXPECT_TRUE(patches.lacks.empty()) << patches.lacks.front();
  const HeldPatch* grip = nullptr;
  for (const HeldPatch& held : patches.cases[static_cast<size_t>(e)].held)
    if (patches.all[held.patch].name == "grip") grip = &held;
  ASSERT_TRUE(grip);
  for (const int n : block_.region("grip").nodes)
    for (const double t : {0.3, 1.0}) {
      const Vector3d X = block_.mesh().X.col(n), u = turn.part(t).apply(X) - X;
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(value_of(grip->motion[static_cast<size_t>(i)], X, t), u[i], 1e-7);
    }
}

TEST_F(Programs, SofaHasTheWholeBody) {
  const Exported out = exported(loaded(), "sofa");
  const XmlFile file(file_of(out, "pull.scn"), "pull.scn", "xml");
  const XmlNode body = file.child("Node").child("Node", "name", "body");
  const auto x = numbers_in(body.child("TetrahedronSetTopologyContainer").attribute("position"));
  ASSERT_EQ(x.size(), static_cast<size_t>(3 * block_.mesh().nodes()));
  const auto at = [&](double node) {
    const auto i = static_cast<size_t>(3 * node);
    return Vector3d(x.at(i), x.at(i + 1), x.at(i + 2));
  };
  const auto tets =
      numbers_in(body.child("TetrahedronSetTopologyContainer").attribute("tetrahedra"));
  ASSERT_EQ(tets.size(), static_cast<size_t>(4 * 8 * block_.mesh().size()));
  double volume = 0;
  for (size_t t = 0; t < tets.size(); t += 4) {
    const Vector3d o = at(tets[t]);
    const double six = (at(tets[t + 1]) - o).cross(at(tets[t + 2]) - o).dot(at(tets[t + 3]) - o);
    EXPECT_GT(six, 0.0);
    volume += six / 6;
  }
  EXPECT_NEAR(volume, 20.0 * 16 * 40, 1e-6);
  const XmlNode field = body.all("TetrahedronHyperelasticityFEMForceField").at(0);
  EXPECT_EQ(field.attribute("materialName"), "MooneyRivlin");
  EXPECT_EQ(field.attribute("ParameterSet"), "0.025 0 0.5");
  Vector3d sum = Vector3d::Zero();
  const auto forces = numbers_in(body.child("ConstantForceField").attribute("forces"));
  for (size_t i = 0; i < forces.size(); ++i) sum[static_cast<Eigen::Index>(i % 3)] += forces[i];
  EXPECT_LT((sum - Vector3d(0.3, 0.1, 4.0)).norm(), 1e-9);
  // Pressure on the top, with normals out of the body and a minus.
  Vector3d pushed = Vector3d::Zero();
  for (const XmlNode& node : body.all("Node")) {
    const XmlNode pressure = node.child("SurfacePressureForceField");
    if (!pressure) continue;
    const auto n = numbers_in(node.child("TriangleSetTopologyContainer").attribute("triangles"));
    for (size_t t = 0; t < n.size(); t += 3)
      pushed += numbers_in(pressure.attribute("pressure")).at(0) * 0.5 *
                (at(n[t + 1]) - at(n[t])).cross(at(n[t + 2]) - at(n[t]));
  }
  EXPECT_LT((pushed - Vector3d(0, 0, -0.01 * block_.region("grip").area)).norm(), 1e-9);
  EXPECT_TRUE(mentions(out.lacks, "log J"));
}

TEST_F(Programs, SofaTellsHowFarTheVolumeIsOff) {
  Model model = block_.model();
  SolverModel solver = solver_model(model);
  const int e = model.scene->example_index("pull");
  // A stretch of all by 1 %: J = 1.0303.
  set_found(solver, e, 1.01 * block_.mesh().X.reshaped());
  const double J = std::pow(1.01, 3);
  EXPECT_NEAR(*logarithm_difference(solver), std::abs(std::log(J) / (J * (J - 1)) - 1), 1e-9);
  const Exported out = export_model(*find_exporter("sofa"), solver);
  EXPECT_TRUE(mentions(out.lacks, "differs by up to 4.4 %")) << out.lacks.front();
}

}  // namespace
}  // namespace hookeye::test
