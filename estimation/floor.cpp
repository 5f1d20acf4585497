#include "estimation/floor.h"

#include <cmath>

namespace hookeye {

Floor measure_floor(const Scene& scene, const Evaluation& evaluation) {
  double r2 = 0.0, count = 0.0;
  for (const auto& example : evaluation.examples) {
    if (!is_rest(scene.capture.examples[example.example])) continue;
    for (const auto& photo : example.photos)
      for (const auto& cell : photo.flow.cells) {
        r2 += cell.r2 - cell.explained;
        count += cell.pixels - 3.0;  // three numbers were fitted to each cell
      }
  }
  // A hundred cells' worth of pixels at least, else the told noise is the better witness.
  if (count < 1000.0) return {};
  return {std::sqrt(r2 / count), "rest photos"};
}

}  // namespace hookeye
