#include "app/machine/speed.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "app/commands/solve.h"
#include "app/interrupt.h"
#include "app/scratch_folder.h"
#include "estimation/evaluation/photo_evaluation.h"
#include "estimation/model/declaration.h"

namespace hookeye {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// The catalogue's block, meshed as bodies are, before cameras of half a megapixel.
std::shared_ptr<const Scene> block() {
  constexpr double kEdge = 4.5;  // 8,000 unknowns
  constexpr int kFiner = 12;
  const ScratchFolder folder("doctor");
  write_example_block(folder.path());
  Capture capture = read_capture(folder.path());
  capture.body.edge = kEdge;
  for (Camera& camera : capture.cameras) {
    camera = camera.resized(kFiner);
    camera.width *= kFiner;
    camera.height *= kFiner;
  }
  return load_scene(capture, false);
}

/// [px] of all pictures of all examples, with derivatives.
double photograph(const Model& model, const std::vector<VectorXd>& states) {
  const Scene& scene = *model.scene;
  const RenderOptions options = render_options(scene);
  std::atomic<size_t> pixels = 0;
  tbb::parallel_for(size_t{0}, states.size(), [&](size_t i) {
    PhotoComparer comparer(model.scene, static_cast<int>(i));
    const size_t photos = scene.capture.examples[i].photos.size();
    for (size_t k = 0; k < photos && !interrupted(); ++k)
      pixels +=
          comparer.render(model, states[i], nullptr, static_cast<int>(k), 0, options).I.pixels();
  });
  if (interrupted()) throw Interrupted{};
  return static_cast<double>(pixels);
}

}  // namespace

Speed measure_speed() {
  constexpr double kSeconds = 2.0;  // of pictures, at least
  const auto begin = Clock::now();
  Speed out;
  const auto scene = block();
  const Model model = realise_model("", scene);
  out.unknowns = 3 * static_cast<int>(scene->body->mesh.nodes());
  out.equilibria = static_cast<int>(model.examples.size());
  std::vector<VectorXd> states(model.examples.size());
  const auto solving = Clock::now();
  auto failures = solve_examples(model, "measuring the speed",
                                 [&](int e, const Equilibrium& state) { states[e] = state.q; });
  fail_on_first(failures);
  out.equilibria_s = since(solving);
  const auto rendering = Clock::now();
  do out.megapixels += 1e-6 * photograph(model, states);
  while (since(rendering) < kSeconds);
  out.pictures_s = since(rendering);
  out.seconds = since(begin);
  return out;
}

}  // namespace hookeye
