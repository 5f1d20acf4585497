// What a capture's photos say against what the capture tells, before anything is fitted.
#pragma once

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/input_error.h"
#include "estimation/inspection/options.h"
#include "estimation/model/model.h"

namespace hookeye {

/// Most likely not what the user meant.
struct CaptureWarning {
  std::string question;  ///< who asked: the name of its file in estimation/inspection/questions
  Place place;           ///< where the capture tells it
  std::string seen;      ///< with numbers
  std::string right;     ///< what would be right
  std::string text() const { return place.str() + ": " + seen + "; " + right; }
};

/// One photo against the model at its told values. NaN: cannot be told.
struct PhotoLook {
  int example = 0, photo = 0;
  bool at_rest = false;      ///< against the body at rest; false: against the first guess
  double overlap = NAN;      ///< of the silhouettes, intersection over union
  double correlation = NAN;  ///< of the pictures over the covered pixels
  double share = NAN;        ///< of the body's patches that are found near their place
  double shift_px = NAN;     ///< rms by which those are off
  std::string no_overlap, no_correlation;  ///< why they cannot be told
  std::filesystem::path picture;           ///< drawn; empty: not asked for
};

/// What a load case would do, by one coarse solve.
struct GuessLook {
  int example = 0;
  double displacement = NAN;  ///< largest of the surface [length]; NaN: no equilibrium was found
  double first_order = NAN;   ///< the same to first order; NaN: nothing holds the body
  std::string failure;        ///< why there is no equilibrium
  double seen_px = NAN;       ///< motion in the photos against the reference photos, rms
  double expected_px = NAN;   ///< of the same points by the first guess, to first order
  double cosine = NAN;        ///< between the two; 1: the same direction everywhere
};

struct Inspection {
  std::vector<PhotoLook> photos;   ///< all, in the capture's order
  std::vector<PhotoLook> cameras;  ///< one a camera: its photo at rest, or else its first one
  std::vector<GuessLook> guesses;  ///< by example; empty: not asked for
  std::string no_guess;            ///< why there is none although it was asked for
  std::vector<CaptureWarning> warnings;
  std::filesystem::path sheet;  ///< the contact sheet; empty: not drawn
};

/// Looks at every photo, then asks every question of estimation/inspection/questions. With `folder`
/// (made where it is not there) draws EXAMPLE_CAMERA.png and contact_sheet.png into it.
Inspection inspect(const Scene& scene, const InspectionOptions& options = {},
                   const std::filesystem::path& folder = {});

}  // namespace hookeye
