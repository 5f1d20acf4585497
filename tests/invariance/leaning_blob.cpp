#include "tests/invariance/leaning_blob.h"

#include "estimation/synth/synth.h"
#include "tests/invariance/transformed.h"
#include "tests/support/temporary_folder.h"

namespace hookeye::test {

namespace {

/// Solved on the mesh that the capture tells, so that nothing but the weight is missing. Bumps, a
/// taper and a lean: no symmetry and no axis of the frame is the body's.
const char* const kRecipe = R"(hookeye_recipe: 1
seed: 5
body:
  shape: block
  size: [20, 16, 34]
  bumps: 0.08
  taper: 0.85
  facet: 7
  mesh: {edge: 8.5}
  density: 1.07e-9
  texture: {texel: 0.16, speckle: 1.8}
material: {law: neo-hookean, true: {mu: 0.02, kappa_over_mu: 10}, told: {mu: 0.02}, fit: [mu]}
cameras: {count: 2, size: [120, 150], distance: 6, focal: 540}
examples:
  rest: {}
  pull: {force: [0, 0, 0.3]}
  side: {force: [0.012, 0.006, 0]}
  poke: {use: validate, force: [-0.008, 0.01, 0.12]}
hidden:
  - {effect: gravity, values: {gravity.x: 2500, gravity.y: 1500, gravity.z: -9300}}
truth: {edge_factor: 1, rays_per_axis: 4, visibility_rays: 256}
)";

}  // namespace

const std::filesystem::path& first_telling() {
  static const TemporaryFolder folder;
  static const std::filesystem::path path = [] {
    synthesize(parse_recipe(kRecipe, "recipe.yaml"), folder / "synthesised").value();
    keep_own_mesh(folder / "synthesised");
    write_transformed(folder / "synthesised", folder / "first", {});
    return folder / "first";
  }();
  return path;
}

}  // namespace hookeye::test
