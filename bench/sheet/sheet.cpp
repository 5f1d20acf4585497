// The experiment of Miguel, Miraut, Otaduy (2016), section 7, made again: thin orthotropic
// stiffening sheets under corner pull and complex shear, three materials, data from other laws on
// another mesh. St Venant-Kirchhoff and the additive model are fitted to one motion and shown on
// both.
//   bench_sheet -o FOLDER [--material knit] [--edge 5] ...
// writes FOLDER/sheet.md (the table) and FOLDER/sheet.png (rows: error of StVK, error of the
// additive model, rendered result, input; columns: the largest corner pull and shear of each
// material).
#include "estimation/sheet.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <Eigen/Dense>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <opencv2/imgproc.hpp>

#include "estimation/evaluation/normal_equations.h"
#include "estimation/evaluation/photo_evaluation.h"
#include "estimation/model/additive_material.h"
#include "estimation/search/progressive.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

struct Material {
  std::string name;
  std::shared_ptr<const EnergyTerm> law;
  double stretch;  ///< size of its motions: a stiff cloth is pulled less far
};

struct Resolution {
  double edge = 5.0, finer = 0.7;  ///< told mesh [mm]; edge of the truth's over it
  int levels = 3, refinements = 24;
};

template <class T>
T value(Result<T> result, const std::string& what) {
  if (!result)
    throw std::runtime_error(what + ": " + result.error().example + " " + result.error().reason);
  return *std::move(result);
}

struct Result {
  std::string material;
  test::MarkerErrors stvk, additive;
  int values = 0;
  std::shared_ptr<const Scene> scene;  ///< both motions
  Fitted stvk_fit, additive_fit;       ///< seen on both, fitted to one
};

test::SheetOptions options_for(const Material& material, const fs::path& folder,
                               const Resolution& how) {
  test::SheetOptions o;
  o.folder = folder;
  o.truth = material.law;
  o.force_share = 0.01;
  o.stretch = material.stretch;
  o.edge = how.edge;
  o.finer = how.finer;
  o.levels = how.levels;
  return o;
}

Result run(const Material& material, const std::string& motion, const fs::path& folder,
           const Resolution& how) {
  test::SheetOptions o = options_for(material, folder / (material.name + "_" + motion), how);
  o.fitted = motion;
  // The fit never sees the other motion, not even to judge a refinement.
  o.only_fitted = true;
  const auto seen = test::make_sheet(o);
  o.only_fitted = false;
  o.folder += "_both";
  Result out;
  out.material = material.name;
  out.scene = test::make_sheet(o);
  Workspace workspace(seen);
  const ModelForm base = base_form(seen);
  const Fitted stvk = value(fit(workspace, base, base.initial()), "StVK");
  out.stvk_fit = value(test::shown_on(out.scene, stvk), "shown");
  out.stvk = test::marker_errors(*out.scene, out.stvk_fit);
  ProgressiveOptions options;
  options.most_refinements = how.refinements;
  const Fitted additive =
      value(fit_progressive(
                workspace, {to_additive(base, stvk.p), to_additive(base, base.initial())}, options),
            "additive");
  out.additive_fit = value(test::shown_on(out.scene, additive), "shown");
  out.additive = test::marker_errors(*out.scene, out.additive_fit);
  const AdditiveModel found = additive_parts(additive.form, additive.p).at(0).model;
  out.values = found.size();
  std::cerr << fmt::format("{} {}: StVK misfit {:.6g}\n", material.name, motion,
                           normal_equations(stvk.evaluation).r2);
  for (const Addend& a : found.addends)
    std::cerr << fmt::format("  {} at {}: {}\n", a.name, fmt::join(a.at, " "),
                             fmt::join(a.stiffness, " "));
  for (const RefinementStage& stage : additive.refinements)
    std::cerr << fmt::format(
        "  {}: {} values, evidence {:.1f}, misfit {:.6g}, held out {:.6g} {}\n", stage.what,
        stage.values, stage.evidence, stage.misfit_fit, stage.misfit_held_out.value_or(0),
        stage.kept ? "kept" : "refused");
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
        if (told.kind != MeasuredSpec::Kind::position_of) continue;
        const double d = std::hypot(told.point.x() - X, told.point.y() - Y);
        if (d < near) near = d, error = (one.predicted - told.value).norm();
      }
      // The picture is written as sRGB: grey as it is seen grows with the error.
      if (near < 3.6) tile.values[y * kTile + x] = static_cast<float>(std::pow(error / full, 2.2));
    }
  return tile;
}

/// Room for the names of rows and columns.
constexpr int kLeft = 150, kTop = 48;

void paste(const Image& tile, Image& out, int column, int row) {
  for (int y = 0; y < std::min(kTile, tile.height); ++y)
    for (int x = 0; x < std::min(kTile, tile.width); ++x)
      out.values[(kTop + row * (kTile + 4) + y) * out.width + kLeft + column * (kTile + 4) + x] =
          std::min(1.0f, tile.values[y * tile.width + x]);
}

void write_at(Image& out, int x, int y, const std::string& text) {
  cv::Mat grey(out.height, out.width, CV_32F, out.values.data());
  cv::putText(grey, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar(0.0), 1, cv::LINE_AA);
}

void draw(const std::vector<Result>& shown, const std::vector<Image>& inputs, int levels,
          const fs::path& file) {
  Image out{
      kLeft + static_cast<int>(2 * shown.size()) * (kTile + 4), kTop + 4 * (kTile + 4), 1, {}};
  out.values.assign(out.pixels(), 1.0f);
  const char* rows[4][2] = {{"error of", "fitted StVK"},
                            {"error of", "additive model"},
                            {"additive model,", "rendered"},
                            {"photo", ""}};
  for (int row = 0; row < 4; ++row)
    for (int line = 0; line < 2; ++line)
      write_at(out, 6, kTop + row * (kTile + 4) + kTile / 2 + 18 * line, rows[row][line]);
  int column = 0;
  for (size_t i = 0; i < shown.size(); ++i)
    for (const char* motion : {"corner", "shear"}) {
      const Result& r = shown[i];
      const std::string name = fmt::format("{}_{}", motion, levels);
      int last = -1;
      for (size_t e = 0; e < r.scene->capture.examples.size(); ++e)
        if (r.scene->capture.examples[e].name == name) last = static_cast<int>(e);
      // One scale a column: the largest error of St Venant-Kirchhoff.
      double full = 0;
      for (const auto& one : r.stvk_fit.evaluation.find(last)->measured) {
        const auto& told = r.scene->capture.examples[last].measured[one.index];
        if (told.kind == MeasuredSpec::Kind::position_of)
          full = std::max(full, (one.predicted - told.value).norm());
      }
      const int left = kLeft + column * (kTile + 4);
      write_at(out, left + 4, 18,
               fmt::format("{}, {}", r.material, column % 2 ? "complex shear" : "corner pull"));
      write_at(out, left + 4, 38, fmt::format("errors: white {:.2f} mm", full));
      paste(error_map(*r.scene, r.stvk_fit, last, full), out, column, 0);
      paste(error_map(*r.scene, r.additive_fit, last, full), out, column, 1);
      paste(rendered(*r.scene, r.additive_fit, last), out, column, 2);
      paste(inputs[static_cast<size_t>(column)], out, column, 3);
      ++column;
    }
  write_image(file, out, Encoding{Encoding::Kind::srgb});
}

/// What the camera saw: photos of the truth, made for the picture only.
std::vector<Image> inputs_of(const Material& material, const fs::path& folder,
                             const Resolution& how) {
  test::SheetOptions o = options_for(material, folder / (material.name + "_input"), how);
  o.kinds = {"photos"};
  test::make_sheet(o);
  std::vector<Image> out;
  for (const char* motion : {"corner", "shear"})
    out.push_back(read_image(o.folder / "photos" / fmt::format("{}_{}.exr", motion, o.levels)));
  return out;
}

void run_all(const fs::path& folder, const Resolution& how, const std::string& only,
             const std::string& only_motion) {
  fs::create_directories(folder);
  // The woven ones are sums of functions of one strain each, which addends come near with ever more
  // control points. Skin is not: exp of a quadratic form of all strains (Fung).
  Eigen::Matrix<double, 9, 1> b;
  b << 20, 8, 8, 5, 3, 3, 6, 4, 4;
  const std::vector<Material> materials = {
      {"knit", test::woven_sheet(0.05, 0.15, 0.06, 8.0, 0.02, 2.0), 1.0},
      {"denim", test::woven_sheet(0.08, 0.25, 1.0, 4.0, 0.4, 10.0), 0.6},
      {"skin", fung(0.02, b, 0.3), 0.8}};
  std::vector<Result> shown;
  std::vector<Image> inputs;
  std::string table =
      "| material | fitted to | shown on | StVK [mm] | additive [mm] | ratio | control values |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const Material& material : materials) {
    if (!only.empty() && material.name != only) continue;
    for (const char* motion : {"corner", "shear"}) {
      if (!only_motion.empty() && motion != only_motion) continue;
      const Result r = run(material, motion, folder, how);
      for (const char* on : {"corner", "shear"}) {
        const bool corner = std::string(on) == "corner";
        const double a = corner ? r.stvk.corner : r.stvk.shear;
        const double b = corner ? r.additive.corner : r.additive.shear;
        const std::string row = fmt::format("| {} | {} | {} | {:.3f} | {:.3f} | {:.1f} | {} |\n",
                                            material.name, motion, on, a, b, a / b, r.values);
        std::cerr << row;
        table += row;
      }
      if (std::string(motion) == "corner") shown.push_back(r);
    }
    if (only_motion.empty())
      for (Image& image : inputs_of(material, folder, how)) inputs.push_back(std::move(image));
  }
  std::ofstream(folder / "sheet.md") << table;
  std::cout << table;
  if (only_motion.empty()) draw(shown, inputs, how.levels, folder / "sheet.png");
}

}  // namespace
}  // namespace hookeye

int main(int argc, char** argv) {
  CLI::App app("Thin orthotropic sheets: St Venant-Kirchhoff against the additive model");
  std::string folder;
  std::string only, motion;
  hookeye::Resolution how;
  app.add_option("-o,--out", folder, "Folder for the captures, the table and the picture")
      ->required();
  app.add_option("--edge", how.edge, "Mesh that is fitted [mm]");
  app.add_option("--finer", how.finer, "Edge of the truth's mesh over that one");
  app.add_option("--levels", how.levels, "Load levels of every motion");
  app.add_option("--refinements", how.refinements, "At most");
  app.add_option("--material", only, "knit, denim or skin alone");
  app.add_option("--motion", motion, "corner or shear alone is fitted (no picture)");
  CLI11_PARSE(app, argc, argv);
  try {
    hookeye::run_all(folder, how, only, motion);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
