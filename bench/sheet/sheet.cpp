// The experiment of Miguel, Miraut, Otaduy (2016), section 7, made again: thin orthotropic
// stiffening sheets under corner pull and complex shear, two materials, data from another law on
// another mesh. St Venant-Kirchhoff and the additive model are fitted to one motion and shown on
// both.
//   bench_sheet -o FOLDER [--kinds positions,forces] [--quick]
// writes FOLDER/sheet.md (the table) and FOLDER/sheet.png (rows: error of StVK, error of the
// additive model, rendered result, input; columns: the largest corner pull and shear of both
// materials).
#include "estimation/sheet.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Dense>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "estimation/additive_material.h"
#include "estimation/photo_evaluation.h"
#include "estimation/progressive.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

struct Material {
  std::string name;
  std::shared_ptr<const EnergyTerm> law;
};

/// Root mean square distance [mm] of the markers from the measured places, per motion.
struct Errors {
  double corner = 0, shear = 0;
};

Errors errors_of(const Scene& scene, const Fitted& fitted) {
  double sum[2] = {0, 0}, count[2] = {0, 0};
  for (const auto& example : fitted.evaluation.examples) {
    const auto& spec = scene.capture.examples[example.example];
    const int motion = spec.name.rfind("shear", 0) == 0;
    for (const auto& one : example.measured) {
      const MeasuredSpec& told = spec.measured[one.index];
      if (told.kind != MeasuredSpec::Kind::position) continue;
      sum[motion] += (one.predicted - told.value).squaredNorm();
      count[motion] += 1;
    }
  }
  return {std::sqrt(sum[0] / count[0]), std::sqrt(sum[1] / count[1])};
}

template <class T>
T value(std::variant<T, NumericalFailure> result, const std::string& what) {
  if (const auto* failure = std::get_if<NumericalFailure>(&result))
    throw std::runtime_error(what + ": " + failure->example + " " + failure->reason);
  return std::get<T>(std::move(result));
}

struct Result {
  Errors stvk, additive;
  int values = 0;
  std::shared_ptr<const Scene> scene;
  Fitted stvk_fit, additive_fit;
};

Result run(const Material& material, const std::string& motion, const fs::path& folder,
           bool quick) {
  test::SheetOptions o;
  o.folder = folder / (material.name + "_" + motion);
  o.truth = material.law;
  o.kinds = {"positions", "forces"};
  o.fitted = motion;
  if (quick) o.edge = 10.0, o.levels = 2;
  Result out;
  out.scene = test::make_sheet(o);
  Workspace workspace(out.scene);
  const ModelForm base = base_form(out.scene);
  out.stvk_fit = value(fit(workspace, base, base.initial()), "StVK");
  out.stvk = errors_of(*out.scene, out.stvk_fit);
  const auto [form, start] = to_additive(base, out.stvk_fit.p);
  ProgressiveOptions options;
  if (quick) options.most_refinements = 8;
  options.fit.max_iterations = 12;
  out.additive_fit = value(fit_progressive(workspace, form, start, options), "additive");
  out.additive = errors_of(*out.scene, out.additive_fit);
  out.values = find_additive(out.additive_fit.form, out.additive_fit.p).model.size();
  for (const RefinementStage& stage : out.additive_fit.refinements)
    std::cerr << fmt::format("  {} {}: {} values {} misfit {:.6g} held out {:.6g} {}\n",
                             material.name, motion, stage.what, stage.values, stage.misfit_fit,
                             stage.misfit_held_out.value_or(0), stage.kept ? "kept" : "refused");
  return out;
}

/// A tile of the picture, 256 px.
constexpr int kTile = 256;

Image rendered(const Scene& scene, const Fitted& fitted, int e) {
  auto capture = scene.capture;
  PhotoSpec photo;
  photo.camera = "above";
  for (auto& example : capture.examples) example.photos = {photo};
  auto with_photo = std::make_shared<Scene>(scene);
  with_photo->capture = capture;
  ModelForm form = fitted.form;
  const ModelForm base = base_form(with_photo);
  form.scene = with_photo;
  form.start = base.start;
  const Model model = form.realise(fitted.p);
  RenderOptions options = render_options(*with_photo);
  options.derivatives = false;
  PhotoComparer comparer(with_photo, e);
  return comparer.render(model, fitted.evaluation.find(e)->equilibrium->q, nullptr, 0, 0, options)
      .I;
}

/// Distances of the markers from the measured places on the rest sheet; white: `full` [mm].
Image error_map(const Scene& scene, const Fitted& fitted, int e, double full) {
  Image tile{kTile, kTile, 1, std::vector<float>(kTile * kTile, 0.0f)};
  const ExampleEvaluation& example = *fitted.evaluation.find(e);
  for (int y = 0; y < kTile; ++y)
    for (int x = 0; x < kTile; ++x) {
      const double X = 44.0 * x / kTile - 2.0, Y = 42.0 - 44.0 * y / kTile;
      double near = 1e9, error = 0;
      for (const auto& one : example.measured) {
        const MeasuredSpec& told = scene.capture.examples[e].measured[one.index];
        if (told.kind != MeasuredSpec::Kind::position) continue;
        const double d = std::hypot(told.point.x() - X, told.point.y() - Y);
        if (d < near) near = d, error = (one.predicted - told.value).norm();
      }
      if (near < 3.6) tile.values[y * kTile + x] = static_cast<float>(0.05 + 0.95 * error / full);
    }
  return tile;
}

void paste(const Image& tile, Image& out, int column, int row) {
  for (int y = 0; y < std::min(kTile, tile.height); ++y)
    for (int x = 0; x < std::min(kTile, tile.width); ++x)
      out.values[(row * (kTile + 4) + y) * out.width + column * (kTile + 4) + x] =
          std::min(1.0f, tile.values[y * tile.width + x]);
}

void draw(const std::vector<Result>& shown, const std::vector<Image>& inputs,
          const fs::path& file) {
  Image out{static_cast<int>(2 * shown.size()) * (kTile + 4), 4 * (kTile + 4), 1, {}};
  out.values.assign(out.pixels(), 1.0f);
  int column = 0;
  for (size_t i = 0; i < shown.size(); ++i)
    for (const char* motion : {"corner", "shear"}) {
      const Result& r = shown[i];
      int last = -1;
      for (size_t e = 0; e < r.scene->capture.examples.size(); ++e)
        if (r.scene->capture.examples[e].name.rfind(motion, 0) == 0) last = static_cast<int>(e);
      // One scale a column: the largest error of St Venant-Kirchhoff.
      double full = 0;
      for (const auto& one : r.stvk_fit.evaluation.find(last)->measured) {
        const auto& told = r.scene->capture.examples[last].measured[one.index];
        if (told.kind == MeasuredSpec::Kind::position)
          full = std::max(full, (one.predicted - told.value).norm());
      }
      paste(error_map(*r.scene, r.stvk_fit, last, full), out, column, 0);
      paste(error_map(*r.scene, r.additive_fit, last, full), out, column, 1);
      paste(rendered(*r.scene, r.additive_fit, last), out, column, 2);
      paste(inputs[static_cast<size_t>(column)], out, column, 3);
      ++column;
    }
  write_image(file, out, Encoding{Encoding::Kind::srgb});
}

/// What the camera saw: photos of the truth, made for the picture only.
std::vector<Image> inputs_of(const Material& material, const fs::path& folder, bool quick) {
  test::SheetOptions o;
  o.folder = folder / (material.name + "_input");
  o.truth = material.law;
  o.kinds = {"photos"};
  if (quick) o.edge = 10.0, o.levels = 2;
  test::make_sheet(o);
  std::vector<Image> out;
  for (const char* motion : {"corner", "shear"})
    out.push_back(read_image(o.folder / "photos" / fmt::format("{}_{}.exr", motion, o.levels)));
  return out;
}

void run_all(const fs::path& folder, bool quick) {
  fs::create_directories(folder);
  const std::vector<Material> materials = {
      {"knit", test::woven_sheet(0.05, 0.15, 0.06, 8.0, 0.02, 2.0)},
      {"denim", test::woven_sheet(0.08, 0.25, 1.0, 4.0, 0.4, 10.0)}};
  std::vector<Result> shown;
  std::vector<Image> inputs;
  std::string table =
      "| material | fitted to | shown on | StVK [mm] | additive [mm] | ratio | control values |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const Material& material : materials) {
    for (const char* motion : {"corner", "shear"}) {
      const Result r = run(material, motion, folder, quick);
      for (const char* on : {"corner", "shear"}) {
        const bool corner = std::string(on) == "corner";
        const double a = corner ? r.stvk.corner : r.stvk.shear;
        const double b = corner ? r.additive.corner : r.additive.shear;
        table += fmt::format("| {} | {} | {} | {:.3f} | {:.3f} | {:.1f} | {} |\n", material.name,
                             motion, on, a, b, a / b, r.values);
      }
      if (std::string(motion) == "corner") shown.push_back(r);
    }
    for (Image& image : inputs_of(material, folder, quick)) inputs.push_back(std::move(image));
  }
  std::ofstream(folder / "sheet.md") << table;
  std::cout << table;
  draw(shown, inputs, folder / "sheet.png");
}

}  // namespace
}  // namespace hookeye

int main(int argc, char** argv) {
  CLI::App app("Thin orthotropic sheets: St Venant-Kirchhoff against the additive model");
  std::string folder;
  bool quick = false;
  app.add_option("-o,--out", folder, "Folder for the captures, the table and the picture")
      ->required();
  app.add_flag("--quick", quick, "A coarse mesh and few refinements: does it run?");
  CLI11_PARSE(app, argc, argv);
  try {
    hookeye::run_all(folder, quick);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
