// A board as its user tells it, for the command line and for Python. Messages name options as the
// command line has them: --squares.
#pragma once

#include <string>
#include <vector>

#include "calibration/board.h"
#include "core/input_error.h"

namespace hookeye {

/// "" and 0: not told.
struct ToldBoard {
  std::string kind = "charuco", squares, dots, dictionary;
  double square = 0, spacing = 0, marker = 0, diameter = 0;
};

/// Where what is told of a calibration was wrong.
inline constexpr const char* kCalibrate = "hookeye calibrate";
InputError bad_calibration(const std::string& wrong, const std::string& right);

/// Throws InputError where this build has nothing that finds boards.
void demand_board_finder();

/// Throws InputError for what is missing, does not go together or is no number of its kind. A
/// ChArUco board that is told without its dictionary has none: find_dictionary().
Board board_of(const ToldBoard& told);

/// "charuco 7x5 20 15", "charuco 7x5 20 15 4X4_50", "chessboard 10x7 25", "circles 11x8 5 3": kind,
/// counts, and lengths in the order of the options. Throws InputError.
ToldBoard told_board(const std::string& words);

/// "mm", "cm", "m", "um": what lengths of a board may be in. Nothing is converted.
const std::vector<std::string>& board_units();
/// Numbers that a lens may have.
const std::vector<int>& lens_numbers();

/// Letters, digits, - and _: it stands in names of files.
bool is_camera_name(const std::string& name);

}  // namespace hookeye
