// Directions that turn with the body, so that the same body told in another frame is asked the same
// questions.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "meshing/tet_mesh.h"

namespace hookeye {

/// Three axes of the body at rest, columns: from the principal ones of its volume to where its
/// surface's normals are nearest to them (the largest sum of A (n.axis)^4; a block's are its
/// edges). A set: order and side are the frame's. Where two principal moments are one, and the
/// surface has no corners either (a cylinder), the frame's own axes decide.
Eigen::Matrix3d own_axes(const TetMesh& mesh);

/// Lines spread over all directions, in coordinates of three axes: the axes themselves first, then
/// 22 between them (110, 111, 311). The same set whatever order and sign the axes have. Any
/// direction is within 19.2 degrees of one; unit length.
std::vector<Vector3d> spread_lines();
constexpr size_t kAxes = 3;  ///< of spread_lines()

/// spread_lines() about own_axes(), each to five digits, as direction_text() tells it: three would
/// turn a plane by as much as changes its evidence by a hundredth.
std::vector<Vector3d> own_lines(const TetMesh& mesh);
/// "(0.314, -0.209, 0.926)": three digits, or five where it takes them to read back the very same.
std::string direction_text(const Vector3d& direction);

}  // namespace hookeye
