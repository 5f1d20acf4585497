// The block of the catalogue as a model, and CalculiX beside it.
#pragma once

#include <fstream>

#include "core/text_file.h"
#include "exporters/exported.h"

namespace hookeye::test {

/// The block's model without photos, at its starting values.
class Block {
 public:
  Block() {
    write_example_block(folder_.path());
    scene_ = load_scene(read_capture(folder_.path()), false);
  }
  Model model() const {
    const ModelForm form = base_form(scene_);
    return form.realise(form.initial());
  }
  const TetMesh& mesh() const { return scene_->body->mesh; }
  const Region& region(const std::string& name) const { return scene_->body->regions.at(name); }
  const std::filesystem::path& folder() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
  std::shared_ptr<const Scene> scene_;
};

inline bool has_ccx() { return std::system("command -v ccx >/dev/null 2>&1") == 0; }

/// First line of a test that runs CalculiX.
#define HOOKEYE_NEEDS_CCX()      \
  if (!hookeye::test::has_ccx()) \
  GTEST_SKIP() << "NOT RUN: there is no ccx (apt-get install calculix-ccx)"

/// The last table of displacements in a .dat, 3 x nodes. Empty: there is none.
inline Eigen::MatrixXd displacements_in(const std::filesystem::path& dat, int nodes) {
  Eigen::MatrixXd out;
  std::ifstream file(dat);
  bool within = false;
  for (std::string line; std::getline(file, line);) {
    if (line.find(" for set ") != std::string::npos) {
      within = line.find("displacements") != std::string::npos;
      if (within) out = Eigen::MatrixXd::Constant(3, nodes, std::nan(""));
      continue;
    }
    std::istringstream words(line);
    int node = 0;
    double x = 0, y = 0, z = 0;
    if (within && words >> node >> x >> y >> z) out.col(node - 1) << x, y, z;
  }
  return out;
}

/// Exports `model`, solves case `name` by CalculiX and here: largest distance of a node over the
/// largest displacement. Records why where there is none.
inline double distance_to_calculix(const Model& model, const std::string& name,
                                   std::vector<std::string>* lacks = nullptr) {
  const int e = model.scene->example_index(name);
  const auto solved = solve_equilibrium(model.scene->body->mesh, model.energy_of(e),
                                        model.examples[static_cast<size_t>(e)].loading);
  if (!solved.has_value()) {
    ADD_FAILURE() << name << ": no equilibrium here";
    return HUGE_VAL;
  }
  SolverModel solver = solver_model(model);
  set_found(solver, e, solved->q);
  const Exported exported = export_model(*find_exporter("calculix"), solver);
  if (lacks) *lacks = exported.lacks;
  const TemporaryFolder folder;
  for (const auto& [file, text] : exported.files) write_text(folder / file, text);
  const SolverCase& one = solver.cases[static_cast<size_t>(e)];
  const std::string command = "cd '" + folder.path().string() +
                              "' && OMP_NUM_THREADS=1 timeout 300 ccx " + one.file +
                              " > log.txt 2>&1 </dev/null";
  const int status = std::system(command.c_str());
  const Eigen::MatrixXd u = displacements_in(folder / (one.file + ".dat"), solver.mesh().nodes());
  const std::string log = read_text(folder / "log.txt");
  if (status != 0 || u.size() == 0) {
    ADD_FAILURE() << name << ": ccx ends with " << status << "\n"
                  << log.substr(log.size() - std::min<size_t>(log.size(), 1500));
    return HUGE_VAL;
  }
  const Eigen::MatrixXd own = one.displacement->reshaped(3, u.cols());
  const double distance = (u - own).colwise().norm().maxCoeff() / own.colwise().norm().maxCoeff();
  std::printf("%s: largest displacement %.4g, CalculiX is off by %.2g of it\n", name.c_str(),
              own.colwise().norm().maxCoeff(), distance);
  return distance;
}

}  // namespace hookeye::test
