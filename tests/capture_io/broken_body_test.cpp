// Captures whose body or material is broken in one place each: the whole message is the contract.
#include <gtest/gtest.h>

#include "capture_io/broken_case.h"

namespace hookeye::test {
namespace {

const BrokenCase broken_bodies[] = {
    {"MissingSurface", swap("rest.obj", "rset.obj"),
     "capture.yaml:5:12: the surface is `rset.obj`\n"
     "  there is no such file; did you mean `rest.obj`?"},
    {"WrongSurfaceType", swap("surface: rest.obj", "surface: albedo.png"),
     "capture.yaml:5:12: the surface is `albedo.png`\n"
     "  a file of type .obj, .ply, .stl is expected"},
    {"NeitherSurfaceNorVolume", swap("  surface: rest.obj\n", ""),
     "capture.yaml:5:3: body lacks one of surface, volume\n"
     "  give a closed surface (obj, ply, stl) or a mesh (msh, vtu, inp, mesh)"},
    {"PathUp", swap("surface: rest.obj", "surface: ../rest.obj"),
     "capture.yaml:5:12: the surface is `../rest.obj`\n"
     "  the path leads out of the capture's folder: put the file inside"},
    {"AbsolutePath", swap("surface: rest.obj", "surface: /etc/passwd"),
     "capture.yaml:5:12: the surface is `/etc/passwd`\n"
     "  paths are relative to the capture's folder"},
    {"SymlinkOut",
     [](CaptureFixture& c) {
       std::filesystem::create_symlink("/etc/passwd", c.folder() / "link.obj");
       c.replace("rest.obj", "link.obj");
     },
     "capture.yaml:5:12: the surface is `link.obj`\n"
     "  the path leads out of the capture's folder: put the file inside"},
    {"PathIsFolder", swap("image: albedo.png", "image: photos"),
     "capture.yaml:8:20: the texture's image is `photos`\n"
     "  this is not a file"},
    {"NegativeEdge", swap("edge: 5.0", "edge: -5.0"),
     "capture.yaml:6:16: the edge of the mesh is `-5.0`\n"
     "  a number above zero is expected"},
    {"OrderThree", swap("order: 2", "order: 3"),
     "capture.yaml:6:28: the order of the mesh is `3`\n"
     "  1 (linear) or 2 (quadratic) is expected"},
    {"NegativeDensity", swap("density: 1.07e-9", "density: -1"),
     "capture.yaml:7:12: the density is `-1`\n"
     "  a number above zero is expected"},
    {"DensityIsText", swap("density: 1.07e-9", "density: 1.07 g/cm3"),
     "capture.yaml:7:12: the density is `1.07 g/cm3`\n"
     "  a number is expected"},
    {"NumberNan", swap("mu: 0.05", "mu: .nan"),
     "capture.yaml:11:36: `mu` of the material is `.nan`\n"
     "  a finite number is expected"},
    {"NumberInfinite", swap("kappa: 0.5", "kappa: 1e999"),
     "capture.yaml:11:49: `kappa` of the material is `1e999`\n"
     "  a finite number is expected"},
    {"GravityWithoutDensity", swap("  density: 1.07e-9\n", ""),
     "capture.yaml:12:12: the model has gravity but the body has no density\n"
     "  give `body: {density: ...}`, for example 1.07e-9 t/mm^3"},
    {"GravityTwoNumbers", swap("[0, 0, -9810]", "[0, -9810]"),
     "capture.yaml:13:12: gravity is a list of 2\n"
     "  three numbers are expected: [x, y, z]"},
    {"TextureTwice",
     swap("{image: albedo.png, encoding: srgb}", "{image: albedo.png, uniform: fit}"),
     "capture.yaml:8:32: texture has both `image` and `uniform`\n"
     "  keep one of the two"},
    {"AlbedoIsNoNumber", swap("{image: albedo.png, encoding: srgb}", "{uniform: grey}"),
     "capture.yaml:8:22: the uniform albedo is `grey`\n"
     "  a number is expected, or `fit`"},
    {"TextureFromUnknown", swap("{image: albedo.png, encoding: srgb}", "{from: rset}"),
     "capture.yaml:8:19: there is no example `rset` to take the texture from\n"
     "  did you mean `rest`?"},
    {"TextureFromHeldOut",
     [](CaptureFixture& c) {
       c.replace("{image: albedo.png, encoding: srgb}", "{from: rest}");
       c.replace("  rest:\n", "  rest:\n    use: validate\n");
     },
     "capture.yaml:8:19: example `rest` is held out: it cannot give the texture\n"
     "  name a fitted example, usually the one at rest"},
    {"ResultsOfOneName",
     [](CaptureFixture& c) {
       c.replace("  pull:\n", "  rest-left:\n");
       c.replace("  left: {calibration", "  left-front: {calibration");
       c.replace("left: photos/rest.png", "left-front: photos/rest.png");
       c.replace("left: {file", "left-front: {file");
     },
     "capture.yaml:55:14: results of example `rest` and of `rest-left` would both be called "
     "rest-left-front\n"
     "  rename an example or a camera"},
    {"TextureFromNoPhotos", swap("{image: albedo.png, encoding: srgb}", "{from: held_out}"),
     "capture.yaml:8:19: example `held_out` has no photos to take the texture from\n"
     "  name an example with photos, usually the one at rest"},
    {"TextureIsNoPicture", swap("image: albedo.png", "image: grip.txt"),
     "capture.yaml:8:20: grip.txt: the file cannot be read as a picture\n"
     "  hand over a complete PNG, TIFF, JPEG or EXR picture"},
    {"NoLaw", swap("law: neo-hookean, mu", "mu"),
     "capture.yaml:11:13: material lacks `law`\n"
     "  write `{law: neo-hookean, mu: 0.05, kappa: 0.5}`"},
    {"RegionsOfMaterialWithoutVolume",
     swap("{law: neo-hookean, mu: 0.05, kappa: 0.5}", "{core: {law: stvk, mu: 1, lambda: 1}}"),
     "capture.yaml:11:13: material names regions of the body, but the body has no volume mesh\n"
     "  give `body: {volume: FILE}` with named groups, one law, or a `blend` each"},
    {"BlendWeights",
     swap("{law: neo-hookean, mu: 0.05, kappa: 0.5}",
          "{law: stvk, mu: 1, lambda: 1, blend: {along: [0, 0, 1], at: [0, 5], weight: [1]}}"),
     "capture.yaml:11:89: 1 weights at 2 places\n"
     "  give one weight at every place"},
    {"BlendPlaces",
     swap("{law: neo-hookean, mu: 0.05, kappa: 0.5}",
          "{law: stvk, mu: 1, lambda: 1, blend: {along: [0, 0, 1], at: [5, 0], weight: [1, 0]}}"),
     "capture.yaml:11:73: the places of the blend do not rise\n"
     "  order them"},
    {"BlendNegative",
     swap("{law: neo-hookean, mu: 0.05, kappa: 0.5}",
          "{law: stvk, mu: 1, lambda: 1, blend: {along: [0, 0, 1], at: [0, 5], weight: [1, -1]}}"),
     "capture.yaml:11:89: a weight of the blend is -1\n"
     "  weights are zero or positive"},
    {"BlendNowhere",
     swap("{law: neo-hookean, mu: 0.05, kappa: 0.5}",
          "{law: stvk, mu: 1, lambda: 1, blend: {along: [0, 0, 0], at: [0, 5], weight: [1, 0]}}"),
     "capture.yaml:11:58: the direction of the blend is zero\n"
     "  write `blend: {along: [0, 0, 1], at: [0, 60], weight: [1, 0]}`"},
    {"FitTwice", swap("[mu, kappa]", "[mu, mu]"),
     "capture.yaml:12:13: `mu` is to be fitted twice\n"
     "  name every parameter once"},
};

INSTANTIATE_TEST_SUITE_P(Body, BrokenCapture, testing::ValuesIn(broken_bodies), case_name);

}  // namespace
}  // namespace hookeye::test
