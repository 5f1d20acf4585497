#include "estimation/field_block.h"

#include <fmt/format.h>

#include <fstream>
#include <map>
#include <random>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "estimation/effects/catalogue.h"
#include "estimation/evaluation/evaluation.h"

namespace hookeye::test {

namespace {

namespace fs = std::filesystem;

const char* const kHead = R"(hookeye: 1
title: block by fields
units: {length: mm, force: N}
body:
  surface: block.obj
  mesh: {edge: 11.0, order: 2}
  density: 1.07e-9
model:
  material: {law: neo-hookean, mu: 0.04, kappa_over_mu: 10.0}
  fit: [mu]
regions:
  base: {box: [[-11, -9, -0.1], [11, 9, 0.1]]}
  grip: {box: [[-11, -9, 39.9], [11, 9, 40.1]]}
examples:
)";

const char* const kBlock = R"(v -10 -8 0
v 10 -8 0
v 10 8 0
v -10 8 0
v -10 -8 40
v 10 -8 40
v 10 8 40
v -10 8 40
f 1 3 2
f 1 4 3
f 5 6 7
f 5 7 8
f 1 2 6
f 1 6 5
f 2 3 7
f 2 7 6
f 3 4 8
f 3 8 7
f 4 1 5
f 4 5 8
)";

struct Load {
  const char *name, *text;
};
const Load kLoads[] = {
    {"rest", ""},
    {"pull", "    loads: [{region: grip, force: [0.3, 0.1, 4.0]}]\n"},
    {"bend", "    loads: [{region: grip, force: [0.5, 0.2, 0]}]\n"},
    {"push", "    use: validate\n    loads: [{region: grip, force: [-0.3, 0.3, -2.0]}]\n"}};

/// A face of the block: where its points are, and along what.
struct Face {
  const char* name;
  Vector3d corner, across;
};
const Face kFaces[] = {{"front", {-9.0, -8.0, 2.0}, {1.0, 0.0, 0.0}},
                       {"flank", {10.0, -7.0, 2.0}, {0.0, 1.0, 0.0}}};
constexpr int kAcross = 8, kUp = 19;
constexpr double kStep = 2.0;

Vector3d point(const Face& face, int i, int j) {
  return face.corner + kStep * (i * face.across + j * Vector3d::UnitZ());
}

void put(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

std::string entry(const FieldBlock& block, const std::string& example, const Face& face) {
  std::string out = fmt::format("    - {{field: {}_{}.csv, sigma: {}{}", example, face.name,
                                block.told > 0.0 ? block.told : block.sigma, block.keys);
  if (!block.strain.empty())
    out += fmt::format(", strain: {}, axes: [[{}, {}, 0], [0, 0, 1]]", block.strain,
                       face.across.x(), face.across.y());
  if (block.from_pull && example == "bend") out += ", from: pull";
  if (block.in_plane)
    out += fmt::format(", frame: {{origin: [{}, {}, 0], x: [{}, {}, 0], y: [0, 0, 1]}}",
                       face.corner.x(), face.corner.y(), face.across.x(), face.across.y());
  return out + "}\n";
}

/// `moved`: of the places, from where they are at rest.
void write_table(const fs::path& file, const Face& face, const FieldBlock& block,
                 const Matrix3Xd& u, const Matrix3Xd& moved) {
  const bool in_plane = block.in_plane;
  std::string text = !block.strain.empty() ? "X,Y,Z,exx,eyy,exy\n"
                     : in_plane            ? "X [mm],Y [mm],U [mm],V [mm]\n"
                                           : "X,Y,Z,U,V,W\n";
  for (int i = 0; i < kAcross; ++i)
    for (int j = 0; j < kUp; ++j) {
      const Vector3d X = point(face, i, j) + moved.col(i * kUp + j), d = u.col(i * kUp + j);
      text += in_plane
                  ? fmt::format("{},{},{},{}\n", kStep * i, X.z(), face.across.dot(d), d.z())
                  : fmt::format("{},{},{},{},{},{}\n", X.x(), X.y(), X.z(), d.x(), d.y(), d.z());
    }
  put(file, text);
}

/// The truth's displacements of a face, with noise.
Matrix3Xd displacements(const FieldBlock& block, const VectorXd& predicted, std::mt19937& engine) {
  std::normal_distribution<double> normal(0.0, block.sigma);
  const Matrix3Xd u = predicted.reshaped(3, kAcross * kUp);
  Matrix3Xd noise(3, u.cols()), out = u;
  for (double& x : noise.reshaped()) x = normal(engine);
  for (int i = 0; i < kAcross; ++i)
    for (int j = 0; j < kUp; ++j)
      out.col(i * kUp + j) += noise.col(block.alike ? i / 3 * 3 * kUp + j / 3 * 3 : i * kUp + j);
  return out;
}

}  // namespace

namespace {

/// The capture with fields that tell of no displacement.
void write_unmoved(const FieldBlock& block, const fs::path& folder) {
  put(folder / "block.obj", kBlock);
  std::string yaml = kHead;
  for (const Load& load : kLoads) {
    if (load.name == std::string("rest") && !block.rest) continue;
    yaml +=
        fmt::format("  {}:\n    supports: [{{region: base, fix: [x, y, z]}}]\n{}    measured:\n",
                    load.name, load.text);
    for (const Face& face : kFaces) {
      write_table(folder / fmt::format("{}_{}.csv", load.name, face.name), face, block,
                  Matrix3Xd::Zero(3, kAcross * kUp), Matrix3Xd::Zero(3, kAcross * kUp));
      yaml += entry(block, load.name, face);
    }
  }
  put(folder / "capture.yaml", yaml);
}

}  // namespace

namespace {

/// What the truth would show: of each example by face.
using Predictions = std::map<std::string, std::vector<VectorXd>>;
Predictions predicted_by_truth(const FieldBlock& block, const fs::path& folder) {
  const auto scene = load_scene(read_capture(folder));
  ModelForm form = base_form(scene);
  form.ingredients.push_back(find_effect("gravity")->candidate(form.realise(form.initial()), ""));
  VectorXd p = form.initial();
  p[0] = block.mu;
  p.tail<3>() = block.gravity;
  Workspace workspace(scene);
  EvaluationOptions options;
  options.derivatives = false;
  options.held_out = true;
  Predictions out;
  const Evaluation seen = workspace.evaluate(form, p, options).value();
  for (const auto& example : seen.examples)
    for (const auto& one : example.measured)
      out[scene->capture.examples[static_cast<size_t>(example.example)].name].push_back(
          one.predicted);
  return out;
}

Predictions predicted_by_truth(const FieldBlock& block) {
  const TemporaryFolder aside;
  write_unmoved(block, aside.path());
  return predicted_by_truth(block, aside.path());
}

fs::path table_of(const fs::path& folder, const std::string& load, size_t face) {
  return folder / fmt::format("{}_{}.csv", load, kFaces[face].name);
}

/// The fields of `bend` from where `pull` has taken their points.
void write_from_pull(const FieldBlock& block, const Predictions& moved, const fs::path& folder,
                     std::mt19937& engine) {
  for (const bool last : {false, true}) {
    Predictions strains;
    if (!block.strain.empty()) {
      if (last) strains = predicted_by_truth(block, folder);
    } else if (!last) {
      continue;
    }
    for (size_t f = 0; f < std::size(kFaces); ++f) {
      const VectorXd& pull = moved.at("pull")[f];
      VectorXd seen = moved.at("bend")[f] - pull;
      if (!block.strain.empty()) seen = last ? strains.at("bend")[f] : VectorXd(0.0 * seen);
      write_table(table_of(folder, "bend", f), kFaces[f], block, displacements(block, seen, engine),
                  pull.reshaped(3, kAcross * kUp));
    }
  }
}

}  // namespace

void FieldBlock::write(const fs::path& folder) const {
  write_unmoved(*this, folder);
  // The truth is solved where whole displacements are asked for.
  FieldBlock whole = *this;
  whole.in_plane = whole.from_pull = false, whole.rest = true;
  const Predictions truth = predicted_by_truth(whole);
  std::mt19937 engine(seed);
  for (const Load& load : kLoads) {
    if (!rest && load.name == std::string("rest")) continue;
    for (size_t f = 0; f < std::size(kFaces); ++f)
      write_table(table_of(folder, load.name, f), kFaces[f], *this,
                  displacements(*this, truth.at(load.name)[f], engine),
                  Matrix3Xd::Zero(3, kAcross * kUp));
  }
  if (!from_pull) return;
  whole.strain.clear(), whole.keys.clear();
  write_from_pull(*this, strain.empty() ? truth : predicted_by_truth(whole), folder, engine);
}

std::shared_ptr<const Scene> FieldBlock::scene() const {
  const TemporaryFolder folder;
  write(folder.path());
  return load_scene(read_capture(folder.path()));
}

void ChangedBlock::write(const fs::path& folder) const {
  block.write(folder);
  std::ostringstream text;
  text << std::ifstream(folder / file).rdbuf();
  std::string all = text.str();
  const size_t at = all.find(from);
  if (at == std::string::npos) throw std::logic_error("not in " + file + ": " + from);
  std::ofstream(folder / file) << all.replace(at, from.size(), to);
}

std::shared_ptr<const Scene> ChangedBlock::scene() const {
  const TemporaryFolder folder;
  write(folder.path());
  return load_scene(read_capture(folder.path()));
}

std::string ChangedBlock::refusal() const {
  const TemporaryFolder folder;
  write(folder.path());
  try {
    load_scene(read_capture(folder.path()));
  } catch (const InputError& error) {
    std::string said = error.what();
    const std::string name = folder.path().string() + "/";
    for (size_t found; (found = said.find(name)) != std::string::npos;)
      said.erase(found, name.size());
    return said;
  }
  return "";
}

}  // namespace hookeye::test
