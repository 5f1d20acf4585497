// real_data_figures SHARED_DATA/real OUT [CASE]: the captures of the shared real data
// (OUT/capture/...), what Hookeye makes of them (standard output) and the pictures of
// docs/real-data.md (OUT/*.png).
#include <fmt/format.h>

#include <exception>

#include "estimation/search/discover.h"
#include "real/cases.h"
#include "real/pictures.h"

namespace {

namespace fs = std::filesystem;
using namespace hookeye;

void print_parameters(const real::Case& fitted) {
  const auto all = fitted.fitted.form.parameters();
  for (size_t i = 0; i < all.size(); ++i)
    fmt::print("  {:18} {:11.5g}   {:11.5g} .. {:11.5g} {}\n", all[i].name, fitted.fitted.p[i],
               fitted.fitted.low[i], fitted.fitted.high[i], all[i].unit);
  for (const auto& sentence : fitted.fitted.undetermined) fmt::print("  {}\n", sentence);
}

void openhole(const fs::path& data, const fs::path& out) {
  real::write_openhole(data, out / "capture" / "openhole", {4, 9, 11});
  real::Case bar = real::fit_capture(out / "capture" / "openhole");
  print_parameters(bar);
  auto show = [&](const std::string& name) {
    for (int step : {4, 9, 11}) {
      const auto dic = real::compare_with_dic(bar, data, step);
      fmt::print("  step {:2}: model {:.4f} px, with residual {:.4f} px rms, most {:.3f} px\n",
                 step, dic.model_px, dic.with_residual_px, dic.largest_px);
    }
    const int e = bar.scene->example_index("step11");
    real::write_motion(out / ("openhole-" + name + ".png"),
                       bar.fitted.evaluation.find(e)->photos.at(0).flow, 0.2);
  };
  show("isotropic");
  const Diagnosis diagnosis = real::diagnose_case(bar);
  fmt::print("{}", real::table(diagnosis));
  for (const auto& effect : diagnosis.effects) {
    if (effect.effect != "anisotropy" || !effect.testable) continue;
    auto refit = add_effect(*bar.workspace, bar.fitted, effect, {});
    if (!refit.has_value()) continue;
    const double before = bar.fitted.evaluation.chi(false);
    bar.fitted = *std::move(refit);
    fmt::print("with anisotropy: chi {:.4f} -> {:.4f}\n", before, bar.fitted.evaluation.chi(false));
    print_parameters(bar);
    show("anisotropic");
  }
}

void reference(const fs::path& data, const fs::path& out) {
  std::vector<Image> pictures;
  for (const std::string mesh : {"b10k", "q10k", "q30k"})
    for (const std::string load : {"A", "B"}) {
      const std::string deck = mesh + "_" + load;
      const auto block = real::solve_reference(data, out / "capture" / deck, deck);
      fmt::print("{}: {} nodes, {:.1e} mm from CalculiX, of {:.2f} mm\n", deck, block.nodes,
                 block.distance_mm, block.largest_mm);
      if (mesh == "q30k") pictures.push_back(block.picture);
    }
  write_image(out / "reference.png", real::side_by_side(pictures));
}

void hidden(const fs::path& data, const fs::path& out) {
  const real::Case block = real::fit_capture(data / "case_b4");
  print_parameters(block);
  const real::ChiByKind chi = real::chi_by_kind(block);
  fmt::print("  chi at rest {:.3f}, loaded {:.3f}, held out {:.3f}\n", chi.rest, chi.loaded,
             chi.held_out);
  std::vector<Image> pictures;
  for (const auto& example : block.fitted.evaluation.examples) {
    const std::string& name = block.scene->capture.examples[example.example].name;
    const PhotoEvaluation& seen = example.photos.at(0);
    fmt::print("  {}: residual motion {:.3f} px rms\n", name, seen.flow.rms_px());
    if (pictures.size() < 3 && !example.held_out) pictures.push_back(real::residual_picture(seen));
  }
  write_image(out / "hidden-b4.png", real::side_by_side(pictures));
}

void silicone(const fs::path& data, const fs::path& out, real::Silicone told) {
  const std::string name = fmt::format("silicone-{}", told.material);
  real::write_diffcal(data, out / "capture" / name, told);
  real::Case bar = real::fit_capture(out / "capture" / name);
  fmt::print("{}: overlap {:.4f}, E/rho {:.1f} m2/s2, {} iterations, {}\n", name,
             real::overlap(bar, 0), 2.98e4 * bar.parameter("mu").value / told.density_si,
             bar.fitted.iterations, bar.fitted.converged ? "converged" : "not converged");
  print_parameters(bar);
  real::write_overlay(out / (name + ".png"),
                      bar.fitted.evaluation.examples.at(0).photos.at(0).model,
                      bar.scene->photos[0][0].planes[0], bar.scene->photos[0][0].valid);
}

void tango(const fs::path& data, const fs::path& out) {
  // No picture of these: the data has no licence.
  real::Tension tension;
  tension.frames = {10, 20, 40, 60};
  double mu = 0.0;
  for (bool fit_jaw : {true, false}) {
    const fs::path folder = out / "capture" / (fit_jaw ? "holes-jaw-fitted" : "holes-jaw-told");
    tension.fit_jaw = fit_jaw;
    real::write_tango_holes(data, folder, tension);
    const real::Case sheet = real::fit_capture(folder);
    print_parameters(sheet);
    mu = sheet.parameter("mu").value;
  }
  for (const auto& frame : real::predict_notched(data, out / "capture" / "notches", mu))
    fmt::print(
        "  notches, frame {}: {:.3f} N, measured {:.3f} N; mouth {:.1f} px, photo {:.1f} px\n",
        frame.frame, frame.predicted_N, frame.measured_N, frame.mouth_px, frame.seen_px);
  tension.frames = {0, 10, 20, 40, 60};
  tension.load_cell_zero_N = 0.0;
  const fs::path folder = out / "capture" / "holes-zero-not-told";
  real::write_tango_holes(data, folder, tension);
  real::Case sheet = real::fit_capture(folder);
  fmt::print("load cell's zero not told: {}", real::table(real::diagnose_case(sheet)));
}

void run(const fs::path& data, const fs::path& out, const std::string& only) {
  fs::create_directories(out);
  auto wanted = [&](const char* name) { return only.empty() || only == name; };
  if (wanted("reference")) reference(data.parent_path() / "reference", out);
  if (wanted("hidden")) hidden(data.parent_path() / "hidden", out);
  if (wanted("openhole")) openhole(data / "openhole_cfrp", out);
  real::Silicone red, blue;
  blue.material = 'm', blue.density_si = 1180.0, blue.start_mu_si = 80000.0;
  if (wanted("red")) silicone(data / "diffcal_silicone", out, red);
  if (wanted("blue")) silicone(data / "diffcal_silicone", out, blue);
  if (wanted("tango")) tango(data / "tango_elastomer_sheet", out);
  if (wanted("laws")) real::compare_laws(data / "tango_elastomer_sheet", out / "capture" / "laws");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    fmt::print(stderr,
               "usage: real_data_figures SHARED_DATA/real OUT "
               "[reference|hidden|openhole|red|blue|tango|laws]\n");
    return 2;
  }
  try {
    run(argv[1], argv[2], argc == 4 ? argv[3] : "");
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
