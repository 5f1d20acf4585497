// model.yaml of a run's step, against a small body.
#include "estimation/model/model.h"

#include "capture_io/capture.h"
#include "estimation/effects/catalogue.h"
#include "fuzz.h"

namespace hookeye::fuzz {
namespace {

std::shared_ptr<const Scene> scene() {
  write("rest.obj",
        "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nv 0 0 10\nv 10 0 10\nv 10 10 10\nv 0 10 10\n"
        "f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\n"
        "f 4 1 5\nf 4 5 8\n");
  write("capture.yaml",
        "hookeye: 1\nunits: {length: mm, force: N}\n"
        "body: {surface: rest.obj, mesh: {edge: 10, order: 1}, density: 1.07e-9}\n"
        "model: {material: {law: neo-hookean, mu: 0.05, kappa: 0.5}, fit: [mu]}\n"
        "regions:\n  base: {box: [[-1, -1, -0.1], [11, 11, 0.1]]}\n"
        "  top: {box: [[-1, -1, 9.9], [11, 11, 10.1]]}\n"
        "examples:\n  pull:\n    supports: [{region: base, fix: [x, y, z]}]\n"
        "    loads: [{region: top, force: [0, 0, 0.1]}]\n");
  return load_scene(read_capture(folder().path()), false);
}

}  // namespace
}  // namespace hookeye::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const auto scene = hookeye::fuzz::scene();
  return hookeye::fuzz::on_file("model.yaml", data, size, [](const auto& file) {
    hookeye::read_model(file, scene, hookeye::catalogue());
  });
}
