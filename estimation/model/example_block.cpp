#include <cmath>
#include <vector>

#include "capture_io/image.h"
#include "core/text_file.h"
#include "estimation/model/declaration.h"

namespace hookeye {

namespace {

const char* const kCapture = R"(hookeye: 1
title: block for the catalogue
units: {length: mm, force: N}
body:
  surface: block.obj
  mesh: {edge: 11.0, order: 2}
  density: 1.07e-9
  texture: {image: albedo.png, encoding: linear}
model:
  material: {law: neo-hookean, mu: 0.05, kappa_over_mu: 10.0}
  fit: [mu]
cameras:
  front:
    size: [64, 48]
    projection: perspective
    intrinsics: {fx: 200, fy: 200, cx: 31.5, cy: 23.5}
    pose: {rotation: [[1, 0, 0], [0, 0, -1], [0, 1, 0]], translation: [0, 20, 200]}
  side:
    size: [64, 48]
    projection: perspective
    intrinsics: {fx: 200, fy: 200, cx: 31.5, cy: 23.5}
    pose: {rotation: [[0, 1, 0], [0, 0, -1], [-1, 0, 0]], translation: [0, 20, 200]}
light:
  ambient: 0.4
  sun: {toward: [0.5, -0.6, 0.62449979983983983], strength: 0.5}
photos:
  encoding: linear
  background: black
  noise: {full_well: 20000, read: 0.001}
regions:
  base: {box: [[-11, -9, -0.1], [11, 9, 0.1]]}
  grip: {box: [[-11, -9, 39.9], [11, 9, 40.1]]}
  flank: {box: [[9.9, -9, 10], [10.1, 9, 30]]}
examples:
  rest:
    supports:
      - {region: base, fix: [x, y, z]}
    photos: {front: grey.png, side: grey.png}
  pull:
    supports:
      - {region: base, fix: [x, y, z]}
    loads:
      - {region: grip, force: [0.3, 0.1, 4.0]}
    photos: {front: grey.png, side: grey.png}
  twist:
    supports:
      - {region: base, fix: [x, y, z]}
      - {region: grip, rigid: {rotate: {axis: [0, 0, 1], degrees: 20, center: [1, 0, 40]}, move: [0.5, 0, 2]}}
    measured:
      - {force_on: grip, value: [0, 0, 1], sigma: 0.1}
    photos: {front: grey.png, side: grey.png}
  bend:
    supports:
      - {region: base, fix: [x, y, z]}
    loads:
      - {region: grip, force: [0.5, 0.2, 0]}
    photos: {front: grey.png, side: grey.png}
  press:
    use: validate
    supports:
      - {region: base, fix: [x, y, z]}
      - {region: grip, rigid: {move: [0, 0, -3]}}
    photos: {front: grey.png, side: grey.png}
)";

const char* const kBlock = R"(v -10 -8 0
v 10 -8 0
v 10 8 0
v -10 8 0
v -10 -8 40
v 10 -8 40
v 10 8 40
v -10 8 40
vt 0 0
vt 1 0
vt 1 1
vt 0 1
f 1/1 3/3 2/2
f 1/1 4/4 3/3
f 5/1 6/2 7/3
f 5/1 7/3 8/4
f 1/1 2/2 6/3
f 1/1 6/3 5/4
f 2/1 3/2 7/3
f 2/1 7/3 6/4
f 3/1 4/2 8/3
f 3/1 8/3 7/4
f 4/1 1/2 5/3
f 4/1 5/3 8/4
)";

}  // namespace

void write_example_block(const std::filesystem::path& folder) {
  write_text(folder / "capture.yaml", kCapture);
  write_text(folder / "block.obj", kBlock);
  write_image(folder / "grey.png", {64, 48, 1, std::vector<float>(64 * 48, 0.25f)});
  Image albedo{64, 64, 1, {}};
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      albedo.values.push_back(0.5f + 0.3f * std::sin(0.7f * x) * std::cos(0.5f * y));
  write_image(folder / "albedo.png", albedo);
}

}  // namespace hookeye
