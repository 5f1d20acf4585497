// Is a distortion told of photos that were undistorted before they were handed over?
#include <fmt/format.h>

#include "estimation/inspection/question.h"

namespace hookeye::inspection {

namespace {

/// Photos are undistorted to a pinhole's, of a fisheye too.
Camera without_distortion(const Camera& told) {
  Camera camera = told;
  camera.distortion.clear();
  if (camera.model->central()) camera.model = &camera_model("perspective");
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
    const Camera& as_told = sight.camera(photo);
    if (as_told.model->linear(as_told.distortion) || sight.doubted(camera)) continue;
    if (!(told.share >= options.found_share && told.shift_px >= options.least_bent_px)) continue;
    Trial trial;
    trial.flip = &straight;
    const Agreement without = sight.agreement(photo, trial);
    if (!(without.shift_px <= options.straighter * told.shift_px)) continue;
    const bool fisheye = without_distortion(as_told).model != as_told.model;
    const bool here = warnings.has({"cameras", camera, "intrinsics", "distortion"});
    const std::string right =
        fisheye ? "of photos that were undistorted before: `projection: perspective`, and leave "
                  "`distortion` out"
                : "of photos that were undistorted before: leave `distortion` out";
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
