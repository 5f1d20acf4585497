// From how far off `hookeye place` finds the body by its outline: place_reach [TRIALS].
// Bodies of tests/placing, two cameras or one, random directions. One line for each distance.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "placing/outlines.h"
#include "tests/placing/placed_capture.h"

int main(int argc, char** argv) {
  using namespace hookeye;
  using Clock = std::chrono::steady_clock;
  const int trials = argc > 1 ? std::max(1, std::atoi(argv[1])) : 10;
  fmt::print("{:>8} {:>8} {:>10} {:>8} {:>12} {:>12} {:>8}\n", "cameras", "degrees", "of size",
             "found", "median mm", "largest mm", "s each");
  for (const int cameras : {2, 1})
    for (const double degrees : {15.0, 30.0, 45.0, 60.0, 90.0}) {
      std::mt19937 random(17);
      std::vector<double> off;
      const double share = degrees / 90.0;
      const auto begin = Clock::now();
      for (int i = 0; i < trials; ++i) {
        const test::PlacedSetup setup{.cameras = cameras};
        const Vector3d middle = test::middle_of(setup.shape);
        // the bracket is 56 mm across
        const test::PlacedCapture placed(setup,
                                         test::random_motion(middle, degrees, share * 56, random));
        off.push_back(
            placed.off(place_by_outlines(placed.scene(), placed.body(), {}).placing.motion));
      }
      const double seconds = std::chrono::duration<double>(Clock::now() - begin).count() / trials;
      std::sort(off.begin(), off.end());
      const double good =
          cameras == 2 ? 0.3 : 3.0;  // mm: a pixel across; one camera along its sight
      const auto found = std::count_if(off.begin(), off.end(), [&](double x) { return x < good; });
      fmt::print("{:8} {:8.0f} {:10.2f} {:5}/{} {:12.3f} {:12.3f} {:8.1f}\n", cameras, degrees,
                 share, found, trials, off[off.size() / 2], off.back(), seconds);
      std::fflush(stdout);
    }
}
