// Decks that are exported and imported again: the same body, supports, loads and laws.
#include "exporters/block.h"
#include "importers/deck.h"

namespace hookeye::test {
namespace {

/// Exports a model to `program`, imports the decks of all load cases, and models what comes out.
class Again {
 public:
  Again(SolverModel told, const std::string& program) : told_(std::move(told)) {
    const Exported exported = export_model(*find_exporter(program), told_);
    std::vector<std::filesystem::path> decks;
    for (const auto& [file, text] : exported.files) {
      write_text(decks_ / file, text);
      if (file.ends_with(".feb") || (file.ends_with(".inp") && file != "mesh.inp"))
        decks.push_back(decks_ / file);
    }
    imported_ = import_decks(decks, scratch_.path());
    for (const auto& [file, text] : imported_.files) write_text(folder_ / file, text);
    write_text(folder_ / "capture.yaml",
               "hookeye: 1\nunits: {length: mm, force: N}\n" + read_text(folder_ / "body.yaml"));
    const auto scene = load_scene(read_capture(folder_.path()), false);
    const ModelForm form = base_form(scene);
    again_ = solver_model(form.realise(form.initial()));
  }

  const SolverModel& told() const { return told_; }
  const SolverModel& again() const { return again_; }
  const ImportedDeck& imported() const { return imported_; }
  std::string text() const {
    return read_text(folder_ / "body.yaml") + read_text(folder_ / "examples.yaml");
  }
  const SolverCase& again(const std::string& name) const {
    for (const SolverCase& one : again_.cases)
      if (one.name == name) return one;
    throw std::out_of_range("no case " + name + "\n" + text());
  }

 private:
  TemporaryFolder decks_, scratch_, folder_;
  ImportedDeck imported_;
  SolverModel told_, again_;
};

void expect_same_loading(const SolverModel& model, const SolverCase& told, const SolverCase& got) {
  EXPECT_EQ(got.loading.prescribed, told.loading.prescribed) << told.name;
  for (size_t i = 0; i < told.loading.prescribed.size(); ++i)
    ASSERT_NEAR(got.loading.displacement_at(model.mesh().X, i, 1),
                told.loading.displacement_at(model.mesh().X, i, 1), 1e-8)
        << told.name;
  EXPECT_LT((got.nodal_force - told.nodal_force).norm(), 1e-8 * (1 + told.nodal_force.norm()))
      << told.name;
  std::map<int, double> own, theirs;
  for (const PressureOn& p : told.pressures)
    for (const auto& [face, share] : p.faces) own[face] += share * p.pressure;
  for (const PressureOn& p : got.pressures)
    for (const auto& [face, share] : p.faces) theirs[face] += share * p.pressure;
  ASSERT_EQ(theirs.size(), own.size()) << told.name;
  for (const auto& [face, pressure] : own) EXPECT_NEAR(theirs.at(face), pressure, 1e-9);
  EXPECT_LT((got.gravity - told.gravity).norm(), 1e-9 * (1 + told.gravity.norm()));
}

TEST(ImportAgain, TheBlockIsTheSame) {
  const Block block;
  for (const char* program : {"calculix", "abaqus", "febio"}) {
    const Again both(solver_model(block.model()), program);
    ASSERT_EQ(both.again().mesh().nodes(), both.told().mesh().nodes());
    EXPECT_LT((both.again().mesh().X - both.told().mesh().X).norm(), 1e-8);
    EXPECT_EQ(both.again().mesh().elements, both.told().mesh().elements);
    const Rubber &told = both.told().materials.at(0).rubber,
                 &got = both.again().materials.at(0).rubber;
    EXPECT_NEAR(got.c10, told.c10, 1e-9 * told.c10);
    EXPECT_NEAR(got.c01, told.c01, 1e-9);
    EXPECT_NEAR(got.kappa, told.kappa, 1e-9 * told.kappa);
    size_t cases = 0;
    for (const SolverCase& one : both.told().cases) {
      if (!one.strains || one.shares.size() > 1 || !one.pressures.empty()) continue;
      expect_same_loading(both.told(), one, both.again(one.name));
      ++cases;
    }
    EXPECT_GE(cases, 2u) << both.text();
  }
}

SolverCase& case_called(SolverModel& model, const std::string& name) {
  for (SolverCase& one : model.cases)
    if (one.name == name) return one;
  throw std::out_of_range("no case " + name);
}

/// The block's pressed region ends within faces of its mesh, which a deck presses by their shares.
TEST(ImportAgain, APressureKeepsItsSum) {
  const Block block;
  SolverModel model = solver_model(block.model());
  case_called(model, "pull").pressures.push_back({block.region("flank").faces, 0.02});
  const Again both(std::move(model), "calculix");
  const auto sum = [](const SolverModel& model, const SolverCase& one) {
    const TetMesh& mesh = model.mesh();
    Vector3d out = Vector3d::Zero();
    for (const PressureOn& p : one.pressures)
      for (const auto& [face, share] : p.faces) {
        const Vector3d a = mesh.X.col(mesh.boundary(0, face)),
                       b = mesh.X.col(mesh.boundary(1, face)),
                       c = mesh.X.col(mesh.boundary(2, face));
        out += 0.5 * share * p.pressure * (b - a).cross(c - a);
      }
    return out;
  };
  size_t pressed = 0;
  for (const SolverCase& one : both.told().cases) {
    if (one.pressures.empty()) continue;
    ++pressed;
    const Vector3d told = sum(both.told(), one), got = sum(both.again(), both.again(one.name));
    EXPECT_LT((told - got).norm(), 1e-6 * told.norm()) << told.transpose() << both.text();
    expect_same_loading(both.told(), one, both.again(one.name));
  }
  EXPECT_GE(pressed, 1u);
}

TEST(ImportAgain, ATurnInStepsIsOneExampleAStep) {
  const Block block;
  SolverModel model = solver_model(block.model());
  case_called(model, "twist").shares = {0.5, 1};
  const Again both(std::move(model), "calculix");
  const SolverModel& told = both.told();
  for (const SolverCase& one : told.cases) {
    if (one.name != "twist") continue;
    const Loading &half = both.again("twist_1").loading, &whole = both.again("twist_2").loading;
    ASSERT_EQ(half.prescribed, one.loading.prescribed) << both.text();
    ASSERT_EQ(whole.prescribed, one.loading.prescribed);
    for (size_t i = 0; i < half.prescribed.size(); ++i) {
      const auto at = [&](const Loading& loading, double share) {
        return loading.displacement_at(told.mesh().X, i, share);
      };
      ASSERT_NEAR(at(half, 1), at(one.loading, 0.5), 1e-8);
      ASSERT_NEAR(at(whole, 1), at(one.loading, 1), 1e-8);
    }
  }
}

VectorXd solved(const SolverModel& model, const SolverCase& one) {
  const auto out = solve_equilibrium(model.mesh(), model.energy, one.loading);
  if (!out.has_value()) throw std::runtime_error("no equilibrium");
  return out->q;
}

/// CalculiX solves the deck, and what is imported from it is solved here.
TEST(ImportAgain, WhatCalculixSolvesIsSolvedAlike) {
  HOOKEYE_NEEDS_CCX();
  const Block block;
  EXPECT_LT(distance_to_calculix(block.model(), "pull"), 1e-3);
  const Again both(solver_model(block.model()), "calculix");
  for (const SolverCase& one : both.told().cases) {
    if (one.name != "pull") continue;
    const VectorXd here = solved(both.told(), one),
                   again = solved(both.again(), both.again("pull"));
    EXPECT_LT((here - again).norm(), 1e-6 * (here - both.told().mesh().X.reshaped()).norm());
  }
}

}  // namespace
}  // namespace hookeye::test
