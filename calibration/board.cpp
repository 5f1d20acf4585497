#include "calibration/board.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

namespace hookeye {

Eigen::Vector3d Board::corner(int id) const {
  const int column = id % corner_columns(), row = id / corner_columns();
  switch (kind) {
    case Kind::circles:
      return {column * pitch, row * pitch, 0.0};
    case Kind::asymmetric_circles:
      return {(2 * column + row % 2) * pitch, row * pitch, 0.0};
    default:
      return {(column + 1) * pitch, (row + 1) * pitch, 0.0};
  }
}

std::string Board::title() const {
  const char* names[] = {"ChArUco board of {}x{} squares", "chessboard of {}x{} squares",
                         "grid of {}x{} dots", "asymmetric grid of {}x{} dots"};
  return fmt::format(fmt::runtime(names[static_cast<int>(kind)]), columns, rows);
}

std::vector<BoardTurn> board_turns(const Board& board) {
  std::vector<BoardTurn> turns;
  const int count = board.corner_count();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (int i = 0; i < count; ++i) middle += board.corner(i) / count;
  const int quarters = board.kind == Board::Kind::charuco ? 1 : 4;  // markers tell the turn
  for (int quarter = 0; quarter < quarters; ++quarter) {
    BoardTurn turn;
    turn.rotation =
        Eigen::AngleAxisd(quarter * M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    turn.shift = middle - turn.rotation * middle;
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d to = turn.rotation * board.corner(i) + turn.shift;
      for (int j = 0; j < count; ++j)
        if ((board.corner(j) - to).norm() < 1e-6 * board.pitch) turn.turned.push_back(j);
    }
    if (static_cast<int>(turn.turned.size()) == count) turns.push_back(std::move(turn));
  }
  return turns;
}

const std::vector<std::string>& board_kinds() {
  static const std::vector<std::string> kinds{"charuco", "chessboard", "circles",
                                              "asymmetric-circles"};
  return kinds;
}

const std::vector<std::string>& marker_dictionaries() {
  static const std::vector<std::string> names{
      "4X4_50",        "4X4_100",        "4X4_250",       "4X4_1000",      "5X5_50",
      "5X5_100",       "5X5_250",        "5X5_1000",      "6X6_50",        "6X6_100",
      "6X6_250",       "6X6_1000",       "7X7_50",        "7X7_100",       "7X7_250",
      "7X7_1000",      "ARUCO_ORIGINAL", "APRILTAG_16h5", "APRILTAG_25h9", "APRILTAG_36h10",
      "APRILTAG_36h11"};
  return names;
}

void pack(Packer& to, const Board& board) {
  to.put(board.kind).put(board.columns).put(board.rows).put(board.pitch).put(board.marker);
  to.put(board.dictionary);
}

Board unpack_board(Unpacker& from) {
  Board board;
  from.get(board.kind);
  from.get(board.columns);
  from.get(board.rows);
  from.get(board.pitch);
  from.get(board.marker);
  from.get(board.dictionary);
  return board;
}

}  // namespace hookeye
