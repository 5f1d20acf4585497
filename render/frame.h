// Everything that is fixed while one picture is made, and what its rays see. Internal to render.
#pragma once

#include <array>
#include <vector>

#include "render/renderer.h"
#include "render/texture_lookup.h"
#include "render/triangle_table.h"
#include "render/view.h"

namespace hookeye {

struct Frame {
  const SurfaceState& state;
  const View& view;
  const RayScene& scene;
  const TriangleTable& table;
  const Texture& texture;
  const PhotoState& photo;
  const RenderOptions& options;
  // Photo texture only.
  const Matrix3Xd* x_reference = nullptr;
  const RayScene* reference_scene = nullptr;
  const View* reference_view = nullptr;
  const SplineImage* spline = nullptr;
};

constexpr int kLanes = 16;
using Lanes = float[kLanes];

/// What up to 16 neighbouring rays hit.
struct alignas(64) Samples {
  Lanes bary[3];
  Lanes h[2];     ///< of the ray, as View has it
  Lanes zoom[2];  ///< RayGrid::zoom there
  Lanes dh[2];    ///< h - h0 of the triangle
  Lanes of_triangle[kTriangleFloats];
  Lanes depth;           ///< the ray's t
  int lit[kLanes];       ///< -1: turned to the sun, which no other part hides; 0: not
  int triangle[kLanes];  ///< -1: the background
  int texel[2][kLanes];  ///< of the triangle
  int count = 0;
};

/// A number of the corners at the point that lane i hits, without the rounding of float.
inline Vector3d interpolate(const Matrix3Xd& at, const std::array<int, 3>& t, const Samples& s,
                            int i) {
  const double b1 = s.bary[1][i], b2 = s.bary[2][i];
  return (1 - b1 - b2) * at.col(t[0]) + b1 * at.col(t[1]) + b2 * at.col(t[2]);
}

/// Follows up to 16 neighbouring rays; shadows and the reference camera's view included.
void trace(const Frame& frame, const Vector2d* h, int count, Samples* out);

/// What a ray says of its pixel at the fixed ray, by the first index of each group. Those of the
/// triangle's corners are a DerivativeSegment::ByVertex.
constexpr int by_position(int corner) { return 6 * corner; }    ///< unit vertex normals held
constexpr int by_second(int corner) { return 6 * corner + 3; }  ///< unit normal; reference position
constexpr int kByPhoto = 18;  ///< by PhotoColumn, those before kBlur
constexpr int kByVignetting = kByPhoto + kBlur;
constexpr int kByUneven = kByVignetting + 1;  ///< from PhotoColumn kUneven on
/// Multiples of four, as lanes.h asks; a row of whole vectors.
constexpr int whole(int floats, int of) { return (floats + of - 1) / of * of; }
constexpr int kFloatsWithoutPhoto = whole(kByPhoto, 4);
constexpr int kFloatsWithoutUneven = whole(kByUneven, kLanes);
constexpr int kAllFloats = whole(kByUneven + kUnevenNumbers, 4);
constexpr int kRayFloats = whole(kAllFloats, kLanes);
inline bool wants_uneven(const Frame& frame) {
  return frame.options.photo_derivative && frame.options.uneven_derivative && frame.photo.shaded;
}
/// Those of them that are wanted; the others have any finite value.
inline int wanted_floats(const Frame& frame) {
  return wants_uneven(frame)              ? kAllFloats
         : frame.options.photo_derivative ? kFloatsWithoutUneven
                                          : kFloatsWithoutPhoto;
}
struct alignas(64) RayRow {
  float value[kRayFloats];
};
struct alignas(64) Shading {
  Lanes I;  ///< gain times the body's intensity
  RayRow ray[kLanes];
};

/// Lanes without a triangle are undefined; so is Shading::ray without derivatives.
void shade(const Frame& frame, const Samples& samples, bool derivatives, Shading* out);

/// Fraction of the sky that each vertex sees: fixed cosine-weighted directions. Held constant in
/// all derivatives.
std::vector<double> sky_visibility(const RayScene& scene, const Matrix3Xd& x,
                                   const Matrix3Xd& normals, int rays);

/// An edge's share in the derivative of one pixel: that by the corners of one triangle and by the
/// photo's numbers before kSpecular (camera and sun).
struct EdgeSegment {
  int pixel = -1, triangle = -1;
  Eigen::Matrix3d d_position = Eigen::Matrix3d::Zero();  ///< column k: by corner k
  Eigen::Matrix<double, kSpecular, 1> d_photo = Eigen::Matrix<double, kSpecular, 1>::Zero();
};

/// Edges of the surface with the triangles at them (second -1 at a boundary).
struct SurfaceEdge {
  int a, b;
  std::array<int, 2> triangle;
  bool seam;  ///< the triangles have different places of the texture here
};
std::vector<SurfaceEdge> surface_edges(const SurfaceMesh& surface);

/// Silhouette term of the derivative: integral over visible contours, and over other edges at which
/// the intensity jumps (facets of flat shading, seams of the texture), of contrast times normal
/// motion, through the pixel filter. Unordered; edges [first, last).
void silhouette_segments(const Frame& frame, const PixelFilter& filter,
                         const std::vector<SurfaceEdge>& edges, size_t first, size_t last,
                         std::vector<EdgeSegment>* out);

/// The same of the shadows that the sun casts: integral over their visible edges of the contrast
/// times the motion that casting edge, receiving triangle, sun and camera give them. Edges
/// [first, last) as casters.
void shadow_segments(const Frame& frame, const PixelFilter& filter,
                     const std::vector<SurfaceEdge>& edges, size_t first, size_t last,
                     std::vector<EdgeSegment>* out);

}  // namespace hookeye
