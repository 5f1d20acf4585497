// Colour of the points that rays hit, before light. Internal to render.
#pragma once

#include "render/frame.h"

namespace hookeye {

struct alignas(64) Albedo {
  Lanes value;
  Lanes by_bary[3];       ///< up to a common number: barycentric coordinates move with sum zero
  Lanes by_reference[3];  ///< by the point's reference position; not of Source::image
};

/// `derivatives` false leaves all but `value` undefined.
void albedo(const Frame& frame, const Samples& samples, bool derivatives, Albedo* out);

}  // namespace hookeye
