// Everything that is fixed while one picture is made, and what one ray sees. Internal to render.
#pragma once

#include <array>
#include <vector>

#include "render/renderer.h"
#include "render/texture_lookup.h"
#include "render/view.h"

namespace hookeye {

struct Frame {
  const SurfaceMesh& surface;
  const Matrix3Xd& x;
  const View& view;
  const RayScene& scene;
  const Matrix3Xd& normals;               ///< unit vertex normals
  const std::vector<Vector3d>& facets;    ///< unit normals of the triangles
  const std::vector<double>& visibility;  ///< of the sky, per vertex
  const Texture& texture;
  const PhotoState& photo;
  const RenderOptions& options;
  // Photo texture only.
  const Matrix3Xd* x_reference = nullptr;
  const RayScene* reference_scene = nullptr;
  const View* reference_view = nullptr;
  const SplineImage* spline = nullptr;
};

/// What a ray hits. triangle < 0: the background.
struct Sample {
  int triangle = -1;
  bool lit = false;  ///< the sun is not hidden by another part
  float depth = 0;   ///< the ray's t
  Vector2d h;
  Vector3d bary;
};

/// Follows up to 16 neighbouring rays; shadows and the reference camera's view included.
void trace(const Frame& frame, const Vector2d* h, int count, Sample* out);

/// gain times the body's intensity under a ray, and its derivatives at the fixed ray.
struct Shade {
  double I = 0;
  Vector3d by_motion;     ///< by the material point's displacement
  Vector3d by_normal;     ///< by the interpolated (not normalised) vertex normals
  Vector3d by_facet;      ///< by the triangle's own unit normal
  Vector3d by_reference;  ///< by the point's reference position
  Eigen::Matrix<double, kPhotoColumns, 1> photo;
};
Shade shade(const Frame& frame, const Sample& sample, bool derivatives);

/// Fraction of the sky that each vertex sees: fixed cosine-weighted directions. Held constant in
/// all derivatives.
std::vector<double> sky_visibility(const RayScene& scene, const Matrix3Xd& x,
                                   const Matrix3Xd& normals, int rays);

/// A silhouette edge's share in the derivative of one pixel.
struct EdgeSegment {
  int pixel, triangle;
  Eigen::Matrix3d d_position;
  Eigen::Matrix<double, 7, 1> d_camera;  ///< w, v, log focal length
};

/// Edges of the surface with the triangles at them (second -1 at a boundary).
struct SurfaceEdge {
  int a, b;
  std::array<int, 2> triangle;
};
std::vector<SurfaceEdge> surface_edges(const SurfaceMesh& surface);

/// Silhouette term of the derivative: integral over visible contours of contrast times normal
/// motion, through the pixel filter. Unordered; edges [first, last).
void silhouette_segments(const Frame& frame, const PixelFilter& filter,
                         const std::vector<SurfaceEdge>& edges, size_t first, size_t last,
                         std::vector<EdgeSegment>* out);

}  // namespace hookeye
