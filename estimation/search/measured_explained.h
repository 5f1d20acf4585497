// Whether the photos and the sensors are explained.
#pragma once

#include <string>

#include "estimation/diagnosis/diagnosis.h"

namespace hookeye {

/// Forces, moments and positions, of fitted and of held-out examples each, are no further off than
/// their told noise and what a finer mesh would change in them allow: the sum of squares is below
/// the 99.9 % point of its distribution. `why` names the worst where they are not.
bool measured_explained(const Fitted& fitted, const Diagnosis& diagnosis,
                        std::string* why = nullptr);

/// The photos are at the floor (explains_photos), none of them shows the body moved
/// (Diagnosis::motions), and the sensors are explained.
bool explained(const Fitted& fitted, const Diagnosis& diagnosis);
/// The photos alone, and the fields.
bool photos_explained(const Fitted& fitted, const Diagnosis& diagnosis);

}  // namespace hookeye
