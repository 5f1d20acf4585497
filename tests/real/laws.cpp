// Which law for a printed elastomer: each fitted to the sheet with two holes up to a third of its
// length, then shown on the sheet with two notches, nothing fitted there.
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "estimation/effects/catalogue.h"
#include "estimation/model/additive_material.h"
#include "estimation/search/progressive.h"
#include "real/cases.h"

namespace hookeye::real {

namespace {

struct Law {
  const char* name;
  const char* material;
  const char* fit;
  bool additive;  ///< told additively from there on
};
/// A thousand times the shear modulus in all of them, as rubber has it: in a thin sheet the data
/// tell no more of kappa than that it is large, and left free it runs off. The additive model's own
/// volume addend is free, from there on.
constexpr Law kLaws[] = {
    {"neo-hookean", "{law: neo-hookean, mu: 0.2, kappa: 200}", "mu", false},
    {"yeoh", "{law: yeoh, c1: 0.1, c2: 0, c3: 0, kappa: 200}", "c1, c2, c3", false},
    {"ogden", "{law: ogden, mu: [0.2], alpha: [2.5], kappa: 200}", "mu1, alpha1", false},
    {"additive", "{law: neo-hookean, mu: 0.2, kappa: 200}", "mu", true},
};

Fitted value(Result<Fitted> result) {
  if (!result) throw std::runtime_error(result.error().example + ": " + result.error().reason);
  return *std::move(result);
}

/// Root mean square of pull over measured pull minus one, in percent.
double force_error(const Case& sheet, const fs::path& data, bool notched, double zero_N,
                   bool held_out) {
  double sum = 0.0, count = 0.0;
  for (const TangoFrame& frame : tango_frames(data, notched)) {
    const int e = sheet.scene->example_index(fmt::format("f{:03d}", frame.frame));
    if (e < 0 || sheet.scene->capture.examples[e].validate != held_out) continue;
    sum += std::pow(pull_N(sheet, e) / (frame.force_N - zero_N) - 1.0, 2);
    count += 1.0;
  }
  return count > 0.0 ? 100.0 * std::sqrt(sum / count) : 0.0;
}

}  // namespace

void compare_laws(const fs::path& data, const fs::path& out) {
  fmt::print(
      "law          values  holes: chi, force | held out: chi, force | notches: chi, force\n");
  for (const Law& law : kLaws) {
    Tension holes;
    holes.frames = {10, 20, 30, 40, 60, 80, 100, 120};
    holes.held_out = {30, 80};
    holes.fit_jaw = false;
    holes.material = law.material;
    holes.fit = law.fit;
    write_tango_holes(data, out / law.name, holes);
    Case sheet = fit_capture(out / law.name);
    if (law.additive)
      sheet.fitted = value(
          fit_progressive(*sheet.workspace, {to_additive(sheet.fitted.form, sheet.fitted.p)}));
    Tension notches = holes;
    notches.frames = {20, 40, 60, 80};
    notches.held_out = {};
    const fs::path other = out / (std::string(law.name) + "-notched");
    write_tango_notched(data, other, notches);
    Case shown;
    shown.scene = load_scene(read_capture(other));
    shown.workspace = std::make_unique<Workspace>(shown.scene);
    const auto [form, p] =
        transfer(sheet.fitted.form.realise(sheet.fitted.p), shown.scene, catalogue());
    shown.fitted = value(assess(*shown.workspace, form, p));
    const double zero = holes.load_cell_zero_N;
    fmt::print("{:12} {:6}  {:.4f} {:5.2f} % | {:.4f} {:5.2f} % | {:.4f} {:5.2f} %\n", law.name,
               sheet.fitted.p.size(), sheet.fitted.evaluation.chi(false),
               force_error(sheet, data, false, zero, false), sheet.fitted.evaluation.chi(true),
               force_error(sheet, data, false, zero, true), shown.fitted.evaluation.chi(false),
               force_error(shown, data, true, zero, false));
    int i = 0;
    for (const auto& parameter : sheet.fitted.form.parameters()) {
      if (parameter.name.find("rigid") == std::string::npos)
        fmt::print("             {} = {:.4g} {}\n", parameter.name, sheet.fitted.p[i],
                   parameter.unit);
      ++i;
    }
    std::fflush(stdout);
  }
}

}  // namespace hookeye::real
