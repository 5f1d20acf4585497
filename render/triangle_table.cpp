#include "render/triangle_table.h"

#include <Eigen/LU>
#include <cmath>

namespace hookeye {

namespace {

/// With P the corners in camera axes (third row 1 where rays are parallel) and Q its inverse,
/// the ray h meets the plane at b = Q (h,1) / sum. About the centroid's h0, Q (h0,1) = 1/3 1^T s0
/// with s0 its inverse depth, so that A = Q_xy / s0.
void set_rays(const View& view, const std::array<int, 3>& t, TriangleTable::Row* row) {
  Matrix3d P;
  for (int k = 0; k < 3; ++k) P.col(k) = view.p.col(t[k]);
  const Vector3d centroid = P.rowwise().mean();
  const double depth = view.central ? centroid.z() : 1.0;
  if (!view.central) P.row(2).setOnes();
  const double det = P.determinant();
  Eigen::Matrix<double, 3, 2> A = Eigen::Matrix<double, 3, 2>::Zero();
  row->h0.setZero();
  row->value[kInverseDepth] = 1;
  if (det != 0 && depth > 0) A = depth * P.inverse().leftCols<2>();
  if (!A.cast<float>().allFinite()) A.setZero();  // seen edge-on: its centroid stands for it
  if (depth > 0) {
    row->h0 = centroid.head<2>() / depth;
    row->value[kInverseDepth] = static_cast<float>(1 / depth);
  }
  for (int i = 0; i < 6; ++i) row->value[kRayToBary + i] = static_cast<float>(A(i % 3, i / 3));
}

void set_texels(const Image& image, const std::array<Vector2d, 3>& uv, TriangleTable::Row* row) {
  Eigen::Matrix<double, 2, 3> at;
  for (int k = 0; k < 3; ++k)
    at.col(k) << uv[k].x() * image.width - 0.5, (1 - uv[k].y()) * image.height - 0.5;
  for (int c = 0; c < 2; ++c) {
    row->texel[c] = static_cast<int>(std::floor(at.row(c).minCoeff()));
    for (int k = 0; k < 3; ++k)
      row->value[kTexels + 2 * k + c] = static_cast<float>(at(c, k) - row->texel[c]);
  }
}

void set_vector(const Vector3d& v, int at, TriangleTable::Row* row) {
  for (int c = 0; c < 3; ++c) row->value[at + c] = static_cast<float>(v[c]);
}

}  // namespace

TriangleTable triangle_table(const SurfaceState& state, const View& view,
                             const Vector3d& scene_centre, const Texture& texture) {
  TriangleTable out;
  const auto& triangles = state.surface.triangles;
  out.rows.resize(triangles.size());
  for (size_t f = 0; f < triangles.size(); ++f) {
    TriangleTable::Row& row = out.rows[f];
    const auto& t = triangles[f];
    row.value.fill(0);
    set_rays(view, t, &row);
    for (int k = 0; k < 3; ++k) {
      set_vector(state.normals.col(t[k]), kNormals + 3 * k, &row);
      set_vector(state.x.col(t[k]) - scene_centre, kCorners + 3 * k, &row);
      row.value[kVisibility + k] = static_cast<float>(state.visibility[t[k]]);
    }
    set_vector(state.facets[f], kFacet, &row);
    if (texture.source == Texture::Source::image)
      set_texels(*texture.image, state.surface.uv[f], &row);
  }
  return out;
}

}  // namespace hookeye
