// Strains that leave as tables and come back as fields; and those of CalculiX.
#include <fmt/format.h>

#include "core/text_file.h"
#include "estimation/field_block.h"
#include "estimation/fit/fit.h"
#include "exporters/block.h"
#include "exporters/seen_surface.h"

namespace hookeye::test {
namespace {

void replace_all(const std::filesystem::path& file, const std::string& from,
                 const std::string& to) {
  std::string text = read_text(file);
  ASSERT_NE(text.find(from), std::string::npos) << from;
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  write_text(file, text);
}

/// A field's table as `export --to dic` writes it is a measurement that the same model meets: its
/// displacements, and its strains beside them.
TEST(StrainExport, WhatIsWrittenIsReadBack) {
  const TemporaryFolder folder;
  FieldBlock{.mu = 0.05, .sigma = 0.01, .strain = "hencky"}.write(folder.path());
  // Displacements of the same points, in the file's own axes.
  replace_all(folder / "capture.yaml", "sigma: 0.01, strain: hencky",
              "sigma: 0.01, gauge: 6, strain: hencky");
  const auto scene = load_scene(read_capture(folder.path()));
  const ModelForm form = base_form(scene);
  Workspace workspace(scene);
  EvaluationOptions plain;
  plain.derivatives = false, plain.held_out = true;
  const auto evaluation = workspace.evaluate(form, form.initial(), plain);
  ASSERT_TRUE(evaluation.has_value());
  SolverModel solver = solver_model(form.realise(form.initial()));
  solver.seen = seen_surface(form.realise(form.initial()), *evaluation, {});
  const Exported tables = export_model(*find_exporter("dic"), solver);
  for (const char* load : {"rest", "pull", "bend", "push"})
    for (const char* face : {"front", "flank"}) {
      const std::string name = fmt::format("{}_{}.csv", load, face);
      write_text(folder / name, file_of(tables, fmt::format("{}-{}_{}.csv", load, load, face)));
      replace_all(folder / "capture.yaml", fmt::format("    - {{field: {},", name),
                  fmt::format("    - {{field: {}, sigma: 0.001}}\n    - {{field: {},", name, name));
    }
  replace_all(folder / "capture.yaml", "strain: hencky", "strain: green");
  const auto again = load_scene(read_capture(folder.path()));
  Workspace other(again);
  const auto read = other.evaluate(base_form(again), base_form(again).initial(), plain);
  ASSERT_TRUE(read.has_value());
  int fields = 0;
  for (const auto& example : read->examples)
    for (const auto& one : example.measured) {
      const MeasuredSpec& told =
          again->capture.examples[static_cast<size_t>(example.example)].measured[one.index];
      EXPECT_LT((one.predicted - told.value).cwiseAbs().maxCoeff(),
                is_strain_field(told) ? 1e-7 : 1e-6)
          << told.field->told;
      fields += is_strain_field(told) && told.value.norm() > 0.1;
    }
  EXPECT_EQ(fields, 6) << "both faces of three loaded cases";
}

/// Nodal strains of the .frd, averaged over elements: xx yy zz xy yz zx.
Eigen::MatrixXd strains_in(const std::filesystem::path& frd, int nodes) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Constant(6, nodes, std::nan(""));
  std::ifstream file(frd);
  bool within = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(" -4")) within = line.find("TOSTRAIN") != std::string::npos;
    if (!within || !line.starts_with(" -1") || line.size() < 85) continue;
    const int node = std::stoi(line.substr(3, 10));
    for (int i = 0; i < 6; ++i) out(i, node - 1) = std::stod(line.substr(13 + 12 * i, 12));
  }
  return out;
}

/// CalculiX's strains at the nodes of two faces, away from their rims, instead of the fields.
void write_strains_of_ccx(const Scene& scene, const Model& model, const std::string& load,
                          const std::filesystem::path& folder) {
  const int e = scene.example_index(load);
  const auto solved = solve_equilibrium(scene.body->mesh, model.energy_of(e),
                                        model.examples[static_cast<size_t>(e)].loading);
  ASSERT_TRUE(solved.has_value());
  SolverModel solver = solver_model(model);
  set_found(solver, e, solved->q);
  const TemporaryFolder aside;
  for (const auto& [file, text] : export_model(*find_exporter("calculix"), solver).files)
    write_text(aside / file, text);
  const std::string deck = solver.cases[static_cast<size_t>(e)].file;
  ASSERT_EQ(
      std::system(("cd '" + aside.path().string() + "' && OMP_NUM_THREADS=1 timeout 300 ccx " +
                   deck + " > log.txt 2>&1 </dev/null")
                      .c_str()),
      0);
  const TetMesh& mesh = scene.body->mesh;
  const Eigen::MatrixXd E = strains_in(aside / (deck + ".frd"), mesh.nodes());
  std::string front = "X,Y,Z,exx,eyy,exy\n", flank = front;
  for (int n = 0; n < mesh.nodes(); ++n) {
    const Vector3d X = mesh.X.col(n);
    if (X.z() < 7.0 || X.z() > 33.0) continue;
    const auto row = [&](double x, double xz) {
      return fmt::format("{},{},{},{},{},{}\n", X.x(), X.y(), X.z(), x, E(2, n), xz);
    };
    if (X.y() < -7.999 && std::abs(X.x()) < 7.0) front += row(E(0, n), E(5, n));
    if (X.x() > 9.999 && std::abs(X.y()) < 5.0) flank += row(E(1, n), E(4, n));
  }
  write_text(folder / (load + "_front.csv"), front);
  write_text(folder / (load + "_flank.csv"), flank);
}

/// The modulus that CalculiX had comes out of its strains, within its interval.
TEST(CalculiX, StrainsGiveTheModulusBack) {
  HOOKEYE_NEEDS_CCX();
  const TemporaryFolder folder;
  FieldBlock{
      .mu = 0.05, .sigma = 3e-3, .keys = ", correlation: 0", .rest = false, .strain = "green"}
      .write(folder.path());
  replace_all(folder / "capture.yaml", "edge: 11.0", "edge: 5.5");
  {
    const auto scene = load_scene(read_capture(folder.path()));
    ModelForm form = base_form(scene);
    VectorXd p = form.initial();
    p[0] = 0.05;
    for (const char* load : {"pull", "bend"})
      write_strains_of_ccx(*scene, form.realise(p), load, folder.path());
  }
  const auto scene = load_scene(read_capture(folder.path()));
  Workspace workspace(scene);
  const ModelForm form = base_form(scene);
  const auto fitted = fit(workspace, form, form.initial());
  ASSERT_TRUE(fitted.has_value());
  EXPECT_NEAR(fitted->p[0], 0.05, 0.005 * 0.05);
  EXPECT_LT(fitted->low[0], 0.05);
  EXPECT_GT(fitted->high[0], 0.05);
  for (const auto& example : fitted->evaluation.examples)
    for (const auto& one : example.measured) {
      const MeasuredSpec& told =
          scene->capture.examples[static_cast<size_t>(example.example)].measured[one.index];
      if (example.held_out) continue;
      const Eigen::MatrixXd e = told.value.reshaped(3, told.value.size() / 3);
      const Eigen::MatrixXd apart = (one.predicted - told.value).reshaped(3, e.cols());
      for (int i = 0; i < 3; ++i)
        EXPECT_LT(apart.row(i).norm(), 0.02 * e.norm()) << told.field->told << " " << i;
      EXPECT_GT(e.row(1).norm(), 0.02 * std::sqrt(static_cast<double>(e.cols())));
    }
}

}  // namespace
}  // namespace hookeye::test
