// Vectors that a sensor tells in other axes: a sign that is the other one, two axes exchanged.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "estimation/inspection/options.h"
#include "meshing/tet_mesh.h"

namespace hookeye::inspection {

/// Told vectors, one a column, and what is expected of them.
struct ToldVectors {
  Matrix3Xd told;                   ///< 3 x n
  std::vector<Matrix3Xd> expected;  ///< 3 x n each: to first order, and in equilibrium
  /// By column: what is expected there is known but for one factor, which such columns share.
  std::vector<char> scaled;
  std::vector<char> sure;           ///< by column: more than noise and a weight
  std::array<bool, 3> sure_told{};  ///< by axis, over all columns: the same
};

/// How the axes of told vectors are to be read: axis k is `sign[k]` times the told axis `from[k]`.
struct AxesRead {
  std::array<int, 3> from{0, 1, 2}, sign{1, 1, 1};
  double told = 0.0;   ///< share of the squares on the changed axes that is not as expected
  double read = 0.0;   ///< the same, read so
  bool whole = false;  ///< the vectors point the other way: all axes that say something do

  bool changes(int axis) const;
  int count() const;  ///< changed axes
  Matrix3Xd of(const Matrix3Xd& told) const;
  /// "z has the other sign", "x and y stand in one another's places".
  std::string in_words() const;
};

/// Share of the squares of all vectors that is not as expected, in the way to expect that leaves
/// least.
double share_left(const ToldVectors& vectors);

/// The reading with the fewest changed axes that makes the vectors of `columns` (ascending; empty:
/// all) fit clearly better, and well. What has next to nothing on an axis, told or expected, says
/// nothing of that axis' sign.
std::optional<AxesRead> read_otherwise(const ToldVectors& vectors, std::vector<int> columns,
                                       const InspectionOptions& options);

}  // namespace hookeye::inspection
