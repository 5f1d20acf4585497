// Where on their triangles rays meet, and the rays to the sun from there. Internal to render.
#pragma once

#include "render/frame.h"

namespace hookeye {

/// Fills in what belongs to the triangles of all lanes (lanes without one take a neighbour's) and
/// the barycentric coordinates, which are not negative.
void meet_triangles(const Frame& frame, const Vector2d* h, Samples* samples);

/// Marks lanes turned to the sun as lit and sets their rays to it.
void shadow_rays(const Frame& frame, Samples* samples, RayPacket* rays);

}  // namespace hookeye
