// What a capture's photos say against what the capture tells, before anything is fitted.
#pragma once

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/input_error.h"
#include "estimation/inspection/options.h"
#include "estimation/inspection/progress.h"
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

/// What of two silhouettes they do not share, of what either covers. Lengths in px of the photo.
struct Apart {
  double photo_alone = 0, model_alone = 0;  ///< share
  /// Largest piece that the photo alone has: its share, middle and size. 0: only a rim.
  double largest = 0, x = 0, y = 0, width = 0, height = 0;
  bool largest_still = false;  ///< it has the same pixels in all photos of the camera
  int photos = 0;              ///< of that camera, of a loaded body, that were compared for that
  double without_still = NAN;  ///< overlap without such pieces of the photo
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
  std::optional<Apart> apart;     ///< of a camera whose overlap is lower than right ones have
  std::filesystem::path picture;  ///< drawn; empty: not asked for
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

/// A measured field against the first guess to first order, at its points and in its components.
/// Lengths are rms over the points [length; of strains 1].
struct FieldMotion {
  int example = 0;
  std::string file;
  Place place;  ///< where the capture names it
  double seen = 0, expected = 0;
  double cosine = 0;  ///< between the two; 1: the same direction everywhere
  /// The same once the best rigid motion is out of each: what the body is bent and stretched by.
  double seen_bent = 0, expected_bent = 0, cosine_bent = 0;
  bool strain = false;  ///< strains: no rigid motion is in them
};

struct Inspection {
  std::vector<PhotoLook> photos;    ///< all, in the capture's order
  std::vector<PhotoLook> cameras;   ///< one a camera: its photo at rest, or else its first one
  std::vector<GuessLook> guesses;   ///< by example; empty: not asked for
  std::vector<FieldMotion> fields;  ///< of all examples with fields
  std::string no_guess;             ///< why there is none although it was asked for
  std::vector<CaptureWarning> warnings;
  std::filesystem::path sheet;  ///< the contact sheet; empty: not drawn
};

/// Looks at every photo, then asks every question of estimation/inspection/questions. With `folder`
/// (made where it is not there) draws EXAMPLE_CAMERA.png and contact_sheet.png into it.
Inspection inspect(const Scene& scene, const InspectionOptions& options = {},
                   const std::filesystem::path& folder = {},
                   const InspectionProgress& progress = {});

}  // namespace hookeye
