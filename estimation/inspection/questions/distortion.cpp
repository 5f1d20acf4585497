// Is a distortion told of photos that were undistorted before they were handed over?
#include <fmt/format.h>

#include "estimation/inspection/question.h"

namespace hookeye::inspection {

namespace {

Camera without_distortion(const Camera& told) {
  Camera camera = told;
  camera.distortion.clear();
  return camera;
}

}  // namespace

void ask_distortion(Sight& sight, Warnings& warnings) {
  const InspectionOptions& options = sight.options();
  Flip straight;
  straight.camera = without_distortion;
  for (const PhotoIndex& photo : sight.references()) {
    const std::string& camera = sight.spec(photo).camera;
    const Agreement& told = sight.agreement(photo);
    if (sight.camera(photo).distortion.empty() || sight.doubted(camera)) continue;
    if (!(told.share >= options.found_share && told.shift_px >= options.least_bent_px)) continue;
    Trial trial;
    trial.flip = &straight;
    const Agreement without = sight.agreement(photo, trial);
    if (!(without.shift_px <= options.straighter * told.shift_px)) continue;
    const bool here = warnings.has({"cameras", camera, "intrinsics", "distortion"});
    const std::string right = "of photos that were undistorted before: leave `distortion` out";
    const std::string off =
        fmt::format("{:.2f} px with the told distortion and by {:.2f} px without", told.shift_px,
                    without.shift_px);
    if (!warnings.also(right, fmt::format("that by camera `{}` by {}", camera, off)))
      warnings.say(
          warnings.place({"cameras", camera, here ? "intrinsics" : "calibration", "distortion"}),
          fmt::format("the photo by camera `{}` at rest is off by {}", camera, off), right);
  }
}

}  // namespace hookeye::inspection
