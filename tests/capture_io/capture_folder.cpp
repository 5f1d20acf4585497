#include "capture_io/capture_folder.h"

#include <fmt/format.h>

#include <fstream>
#include <stdexcept>

#include "capture_io/capture.h"
#include "core/text_file.h"

namespace hookeye::test {
namespace {

namespace fs = std::filesystem;

const char* const valid_yaml = R"(hookeye: 1
title: silicone block
units: {length: mm, force: N}
body:
  surface: rest.obj
  mesh: {edge: 5.0, order: 2}
  density: 1.07e-9
  texture: {image: albedo.png, encoding: srgb}
  placement: fit
model:
  material: {law: neo-hookean, mu: 0.05, kappa: 0.5}
  fit: [mu, kappa]
  gravity: [0, 0, -9810]
cameras:
  front:
    size: [8, 6]
    projection: perspective
    intrinsics: {fx: 11, fy: 12, cx: 3.5, cy: 2.5, distortion: [0.1, 0, 0, 0, 0]}
    pose: {rotation: [[1,0,0],[0,0,-1],[0,1,0]], translation: [0, 40, 300]}
  left: {calibration: left.yml}
  top:
    size: [8, 6]
    projection: orthographic
    intrinsics: {scale: 2, cx: 3.5, cy: 2.5}
    pose:
      rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
      translation: [0, 0, 50]
light:
  ambient: 0.4
  sun: {toward: [-0.3, -0.5, 0.8], strength: 0.6}
photos:
  encoding: srgb
  noise: {full_well: 20000, read: 0.0011}
  background: black
regions:
  base: {box: [[-50, -50, -0.1], [50, 50, 0.1]]}
  grip: {faces: grip.txt}
  ball: {sphere: {center: [0, 0, 40], radius: 5}}
  side: {halfspace: {point: [10, 0, 0], normal: [2, 0, 0]}}
  inner: {group: cavity}
examples:
  rest:
    photos: {front: photos/rest.png, left: photos/rest.png}
  pull:
    use: fit
    supports:
      - {region: base, fix: [x, y, z]}
      - {region: grip, move: {x: 0, y: 0.5}}
      - {region: ball, rigid: {rotate: {axis: [0, 0, 1], degrees: 20, center: [0, 0, 80]}, move: [0, 0, 5]}}
      - {region: side, rigid: fit}
    loads:
      - {region: grip, force: [0, 0, 2.5]}
      - {region: inner, pressure: 0.002}
    photos:
      front: photos/pull.png
      left: {file: photos/pull.png, mask: photos/mask.png, noise: 0.004, encoding: 2.2}
      top: {file: photos/top.png, kind: silhouette}
    measured:
      - {force_on: grip, value: [0, 0, 2.5], sigma: 0.02}
      - {moment_on: grip, about: [0, 0, 80], value: [0, 0, 35], sigma: 2.0}
      - {position_of: [10, 0, 80], value: [10.2, 0, 92.1], sigma: 0.1}
  held_out:
    use: validate
    supports:
      - {region: base, fix: [z]}
)";

const char* const calibration_yml = R"(%YAML:1.0
---
image_width: 8
image_height: 6
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 20., 0., 3., 0., 21., 2., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.1, 0.01, 0.001, -0.002, 0. ]
R: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 1., 0., 0., 0., 0., -1., 0., 1., 0. ]
T: !!opencv-matrix
   rows: 3
   cols: 1
   dt: d
   data: [ 1., 2., 300. ]
)";

}  // namespace

CaptureFixture::CaptureFixture() : yaml(valid_yaml) {
  fs::create_directories(folder() / "photos");
  write_grey("albedo.png", 4, 4);
  for (const char* name : {"rest", "pull", "top", "mask"})
    write_grey(fmt::format("photos/{}.png", name), 8, 6);
  write_file("rest.obj",
             "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  write_file("grip.txt", "0 1\n3\n");
  write_file("left.yml", calibration_yml);
}

void CaptureFixture::replace(const std::string& from, const std::string& to) {
  const size_t at = yaml.find(from);
  if (at == std::string::npos || yaml.find(from, at + 1) != std::string::npos)
    throw std::logic_error("not exactly once in the capture: " + from);
  yaml.replace(at, from.size(), to);
}

void CaptureFixture::part_cameras() {
  const size_t begin = yaml.find("cameras:\n"), end = yaml.find("light:\n");
  write_file("cameras.yaml", yaml.substr(begin, end - begin));
  yaml.replace(begin, end - begin, "cameras: {from: cameras.yaml}\n");
}

void CaptureFixture::write() const { write_file("capture.yaml", yaml); }

void CaptureFixture::write_file(const std::string& name, const std::string& content) const {
  // Not write_text(): its sync would cost minutes over thousands of damaged files.
  std::ofstream(folder() / name, std::ios::binary) << content;
}

void CaptureFixture::write_grey(const std::string& name, int width, int height, float value,
                                int channels) const {
  Image image{width, height, channels, {}};
  image.values.assign(image.pixels() * channels, value);
  write_image(folder() / name, image);
}

std::string CaptureFixture::complaint() const {
  try {
    read_capture(folder());
    return "";
  } catch (const InputError& error) {
    std::string text = error.what();
    const std::string prefix = folder().string() + "/";
    for (size_t at; (at = text.find(prefix)) != std::string::npos;) text.erase(at, prefix.size());
    return text;
  }
}

}  // namespace hookeye::test
