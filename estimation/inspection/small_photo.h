// A photo at the size that questions look at, and what of it is the body.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "estimation/inspection/options.h"
#include "estimation/model/model.h"

namespace hookeye::inspection {

/// The pixels of a photo that show the body, told without the model.
struct Foreground {
  std::vector<bool> pixels;  ///< empty: cannot be told
  bool known() const { return !pixels.empty(); }
  /// 0 or 1 per pixel.
  std::vector<unsigned char> inside() const { return {pixels.begin(), pixels.end()}; }
  bool told = false;  ///< by what the capture says to be behind the body; false: by an even border
  std::string unknown;  ///< why it cannot be told
};

struct SmallPhoto {
  int level = 0;         ///< how often the scene's photo was halved
  int halvings = 0;      ///< how often the file's was
  SharedValue<Image> I;  ///< one channel, linear
  SharedValue<std::vector<unsigned char>> valid;
  Foreground foreground;
  double px() const { return std::exp2(halvings); }  ///< px of the file in one of these
};

/// Photo `k` of example `e`, halved until its longer side is at most options.look_px.
SmallPhoto small_photo(const Scene& scene, int e, int k, const InspectionOptions& options);

/// The plane of a photo that is looked at: of three channels the green one.
int looked_at_plane(const Photo& photo);

/// Share of the pixels that both or either cover: intersection over union. `valid` (may be empty):
/// pixels that count. NaN where neither covers anything.
double overlap(const std::vector<unsigned char>& one, const std::vector<unsigned char>& other,
               const std::vector<unsigned char>& valid);

}  // namespace hookeye::inspection
