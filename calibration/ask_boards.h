// Questions to the helper that has OpenCV's calib3d and aruco (helpers/boards.cpp).
#pragma once

#include <string>

#include "calibration/board.h"
#include "capture_io/image.h"
#include "core/helper.h"

namespace hookeye {

/// How the photo's light becomes grey of 8 bits. As eyes see it, dark markers are found in deep
/// shade; but bright edges spread into dark ones, so that a black square is seen too small.
enum class Grey { as_seen, linear };

/// A task's name, the board, and the photo in grey.
Packer boards_request(const char* task, const Image& photo, const Board& board,
                      Grey grey = Grey::as_seen);
HelperRequest to_boards(Packer& what, const std::string& file);

/// The answer as `unpack(Unpacker&)` makes it; it throws WireFault for what it cannot read. Throws
/// InputError.
template <class Unpack>
auto ask_boards(Packer& what, const std::string& file, const Unpack& unpack) {
  return ask_helper(to_boards(what, file), unpack);
}

}  // namespace hookeye
