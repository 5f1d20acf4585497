// What a fitted model leaves, over the floor.
#pragma once

#include <string>

#include "estimation/fit/fit.h"
#include "estimation/fit/floor.h"

namespace hookeye {

/// Within FloorLimits::at times the floor on the fitted photos and on the held-out ones.
bool at_floor(const Fitted& fitted, const Floor& floor);
/// Within FloorLimits::on times: no more is left than renderers leave at least.
bool on_floor(const Fitted& fitted, const Floor& floor);
/// Who keeps most over the floor of its own (Floor::by_camera), on fitted or on held-out photos.
struct CameraOverFloor {
  std::string camera;  ///< "": no camera has a floor of its own
  double times = 0.0;
  bool held_out = false;
};
CameraOverFloor most_over_floor(const Fitted& fitted, const Floor& floor);
/// At the floor, and no camera is over it by what is its own rather than all cameras' alike (and
/// more than renderers leave at rest): what is wrong with one of them is thin in the mean of many.
bool explains_photos(const Fitted& fitted, const Floor& floor);
/// What chi^2 has over the floor's.
double over_floor(const Fitted& fitted, const Floor& floor, bool held_out);
/// The effects explain the fitted photos and not the held-out ones.
bool spoils_held_out(const Fitted& fitted, const Floor& floor);

}  // namespace hookeye
