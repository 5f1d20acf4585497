// What stands in the decks, without a solver.
#include "exporters/deck.h"

#include <map>
#include <set>

#include "exporters/block.h"

namespace hookeye::test {
namespace {

Exported exported(const Model& model, const std::string& to) {
  return export_model(*find_exporter(to), solver_model(model));
}

/// Nodes of mesh.inp by number.
std::map<int, Vector3d> nodes_of(const std::string& mesh) {
  std::map<int, Vector3d> out;
  for (const auto& line : behind(mesh, "*NODE,")) {
    const auto n = numbers_of(line);
    out[static_cast<int>(n.at(0))] = {n.at(1), n.at(2), n.at(3)};
  }
  return out;
}

TEST(Deck, MiddleNodesLieOnTheEdgesThatTheProgramsMean) {
  const Block block;
  const std::string mesh = file_of(exported(block.model(), "calculix"), "mesh.inp");
  const auto x = nodes_of(mesh);
  // Abaqus and CalculiX manuals, C3D10: 5 on 1-2, 6 on 2-3, 7 on 3-1, 8 on 1-4, 9 on 2-4, 10 on
  // 3-4.
  const int edges[6][2] = {{1, 2}, {2, 3}, {3, 1}, {1, 4}, {2, 4}, {3, 4}};
  const auto lines = behind(mesh, "*ELEMENT, TYPE=C3D10");
  ASSERT_EQ(lines.size(), static_cast<size_t>(block.mesh().size()));
  for (const auto& line : lines) {
    const auto n = numbers_of(line);
    ASSERT_EQ(n.size(), 11u);
    const auto at = [&](int k) { return x.at(static_cast<int>(n[static_cast<size_t>(k)])); };
    for (int k = 0; k < 6; ++k)
      EXPECT_LT((at(5 + k) - 0.5 * (at(edges[k][0]) + at(edges[k][1]))).norm(), 1e-9);
    EXPECT_GT((at(2) - at(1)).cross(at(3) - at(1)).dot(at(4) - at(1)), 0.0);
  }
}

TEST(Deck, SetsAreFullAndInRange) {
  const Block block;
  for (const char* to : {"abaqus", "calculix"}) {
    const std::string mesh = file_of(exported(block.model(), to), "mesh.inp");
    for (const char* set : {"BASE", "GRIP", "FLANK"}) {
      const auto lines = behind(mesh, std::string("*NSET, NSET=") + set);
      std::set<int> nodes;
      for (const auto& line : lines)
        for (const double n : numbers_of(line)) nodes.insert(static_cast<int>(n));
      ASSERT_FALSE(nodes.empty()) << set;
      EXPECT_GE(*nodes.begin(), 1);
      EXPECT_LE(*nodes.rbegin(), block.mesh().nodes());
    }
  }
}

TEST(Deck, ForcesSumToTheLoad) {
  const Block block;
  const std::string deck = file_of(exported(block.model(), "abaqus"), "pull.inp");
  Vector3d sum = Vector3d::Zero();
  for (const auto& line : behind(deck, "*CLOAD")) {
    const auto n = numbers_of(line);
    sum[static_cast<int>(n.at(1)) - 1] += n.at(2);
  }
  EXPECT_LT((sum - Vector3d(0.3, 0.1, 4.0)).norm(), 1e-9);
}

TEST(Deck, WeightIsGravAndNotForces) {
  const Block block;
  Model model = block.model();
  const auto weight = self_weight(block.mesh(), 1.07e-9, Vector3d(0, 0, -9810));
  for (auto& example : model.examples) example.loading.forces.push_back(weight);
  model.gravity = Vector3d(0, 0, -9810);
  const std::string deck = file_of(exported(model, "calculix"), "rest.inp");
  EXPECT_TRUE(behind(deck, "*CLOAD").empty());
  EXPECT_EQ(behind(deck, "*DLOAD").at(0), "EALL,GRAV,9810,0,0,-1");
  EXPECT_EQ(behind(deck, "*DENSITY").at(0), "1.07e-09");
}

/// The faces that are pressed, by the manual's corners of P1 .. P4, point out of the body at +x.
TEST(Deck, PressureActsOnThePatch) {
  const Block block;
  Model model = block.model();
  model.examples[0].loading.forces.push_back(follower_pressure(block.region("flank"), 0.01));
  const Exported out = exported(model, "calculix");
  const auto x = nodes_of(file_of(out, "mesh.inp"));
  const auto elements = behind(file_of(out, "mesh.inp"), "*ELEMENT");
  const int corners[4][3] = {{1, 2, 3}, {1, 4, 2}, {2, 4, 3}, {3, 4, 1}};
  double force = 0;
  for (const auto& line : behind(file_of(out, "rest.inp"), "*DLOAD")) {
    const auto first = line.find(','), second = line.find(',', first + 1);
    const size_t e = std::stoul(line.substr(0, first));
    ASSERT_EQ(line[first + 1], 'P');
    const int face = std::stoi(line.substr(first + 2)) - 1;
    const auto n = numbers_of(elements.at(e - 1));
    const auto at = [&](int k) {
      return x.at(static_cast<int>(n[static_cast<size_t>(corners[face][k])]));
    };
    const Vector3d a = at(0), b = at(1), c = at(2);
    EXPECT_NEAR(a.x() + b.x() + c.x(), 30.0, 1e-6);
    force += std::stod(line.substr(second + 1)) * 0.5 * (b - a).cross(c - a).norm();
  }
  EXPECT_NEAR(force, 0.01 * block.region("flank").area, 1e-6);
}

TEST(Deck, CalculiXPressesInSmallIncrements) {
  const Block block;
  Model model = block.model();
  model.examples[0].loading.forces.push_back(follower_pressure(block.region("flank"), 0.01));
  const Exported calculix = exported(model, "calculix"), abaqus = exported(model, "abaqus");
  const auto increments = [](const Exported& out, const std::string& name) {
    return behind(file_of(out, name), "*STATIC");
  };
  EXPECT_EQ(increments(calculix, "rest.inp"), std::vector<std::string>{"0.05,1.,1e-5,0.05"});
  EXPECT_EQ(increments(calculix, "pull.inp"), std::vector<std::string>{"0.25,1.,1e-5,0.5"});
  EXPECT_EQ(increments(abaqus, "rest.inp"), std::vector<std::string>{"0.25,1.,1e-5,0.5"});
}

TEST(Deck, NumbersFitTheirFields) {
  const Block block;
  Model model = block.model();
  for (const char* name : {"mesh.inp", "twist.inp"}) {
    std::istringstream lines(file_of(exported(model, "calculix"), name));
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(line.size(), 256u);
      std::istringstream words(line.starts_with("*") ? "" : line);
      for (std::string word; std::getline(words, word, ',');) EXPECT_LE(word.size(), 20u) << line;
    }
  }
}

TEST(Deck, NamesOfRegionsBecomeSets) {
  SolverModel model;
  const Region region;
  for (const char* name : {"top", "Top", "7 o'clock", "NALL"})
    model.regions.emplace_back(name, &region);
  EXPECT_EQ(deck::set_names(model),
            (std::vector<std::string>{"TOP", "TOP_2", "R7_O_CLOCK", "NALL_2"}));
}

TEST(Deck, WhatIsLackingIsSaid) {
  const Block block;
  Model model = block.model();
  model.energy.parts.push_back({fibre(0.1, Vector3d::UnitX()), {}});
  for (auto& example : model.examples)
    example.loading.forces.push_back(
        floor_contact(block.mesh(), Vector3d(0, 0, -1), Vector3d::UnitZ(), 1, 0.1));
  const Exported out = exported(model, "abaqus");
  EXPECT_TRUE(mentions(out.lacks, "fibre"));
  EXPECT_TRUE(mentions(out.lacks, "floor"));
  const std::string& readme = file_of(out, "README.txt");
  EXPECT_NE(readme.find("fibre"), std::string::npos);
  model.energy.parts = {{stvk(0.4, 0.05), {}}};
  EXPECT_TRUE(mentions(exported(model, "abaqus").lacks, "*ELASTIC"));
  EXPECT_FALSE(mentions(exported(model, "calculix").lacks, "*ELASTIC"));
}

}  // namespace
}  // namespace hookeye::test
