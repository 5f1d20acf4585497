// The usual ways in which a camera, a photo or a texture is given the wrong way round.
#pragma once

#include <string>
#include <vector>

#include "capture_io/camera.h"
#include "capture_io/image.h"

namespace hookeye::inspection {

/// How a picture is put right.
enum class Turn { none, half, left, right, mirrored, upside_down };

/// One mistake, undone: the told camera and picture become those that were meant.
struct Flip {
  enum class Of { nothing, pose, intrinsics, photo, texture };

  std::string name;   ///< "camera_to_world"
  std::string seen;   ///< completes "the body fits the photo if ..."
  std::string right;  ///< what to write or do
  Of of = Of::nothing;
  Camera (*camera)(const Camera&) = nullptr;  ///< full size; null: as it is
  Turn turn = Turn::none;
  bool texture_v = false;  ///< v of the texture counts from the top

  Camera meant(const Camera& told) const;
};

/// Nothing is wrong.
const Flip& as_told();
/// All of the list, the likelier first. A new one is a line in flip.cpp.
const std::vector<Flip>& usual_flips();
/// Two at once: poses the other way round whose lengths are in m for mm, or in mm for m, as
/// programs that draw or reconstruct scenes write them.
const std::vector<Flip>& paired_flips();

Image turned(const Image& image, Turn turn);
std::vector<unsigned char> turned(const std::vector<unsigned char>& values, int width, int height,
                                  Turn turn);

}  // namespace hookeye::inspection
