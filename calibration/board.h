// A flat board with corners or dots at known places.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/wire.h"

namespace hookeye {

/// Axes of a board: x along its rows, y down its columns as one reads it, z into the board. The
/// origin is the outer corner of the first square, or the centre of the first dot.
struct Board {
  enum class Kind { charuco, chessboard, circles, asymmetric_circles };
  Kind kind = Kind::charuco;
  int columns = 0, rows = 0;  ///< squares; dots: in a row, and rows
  /// Side of a square; distance of dots in a row; of an asymmetric grid between its rows, which is
  /// half of that in a row [length].
  double pitch = 0;
  double marker = 0;       ///< side of a marker [length]; charuco alone
  double diameter = 0;     ///< of a dot [length]; 0: not told
  std::string dictionary;  ///< "4X4_50"; charuco alone

  bool dots() const { return kind == Kind::circles || kind == Kind::asymmetric_circles; }
  int corner_columns() const { return dots() ? columns : columns - 1; }
  int corner_rows() const { return dots() ? rows : rows - 1; }
  int corner_count() const { return corner_columns() * corner_rows(); }
  int marker_count() const { return columns * rows / 2; }
  /// Corner `id`, row by row [length]; z is 0.
  Eigen::Vector3d corner(int id) const;
  /// "ChArUco board of 7x5 squares".
  std::string title() const;
};

/// Turns of the board, in its plane, that a photo cannot tell from none: the first is none. A
/// corner that was taken for `id` may be `turned[id]`; the board stood turned by `rotation`,
/// `shift`.
struct BoardTurn {
  std::vector<int> turned;
  Eigen::Matrix3d rotation;
  Eigen::Vector3d shift;  ///< corner(turned[id]) = rotation corner(id) + shift
};
std::vector<BoardTurn> board_turns(const Board& board);

/// Of markers, "4X4_50" .. "APRILTAG_36h11", in the order of OpenCV's numbers.
const std::vector<std::string>& marker_dictionaries();

/// "charuco", "chessboard", "circles", "asymmetric-circles", in the order of Kind.
const std::vector<std::string>& board_kinds();

void pack(Packer& to, const Board& board);
Board unpack_board(Unpacker& from);

}  // namespace hookeye
