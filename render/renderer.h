// Renders a triangle surface and differentiates the picture. The only file that touches Embree is
// ray_scene.cpp.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "capture_io/image.h"
#include "meshing/surface_mesh.h"
#include "render/optics.h"

namespace hookeye {

struct RenderOptions {
  int rays_per_axis = 3;         ///< fixed pattern of rays_per_axis^2 rays per pixel
  double filter_width_px = 3.0;  ///< whole Blackman-Harris window over which the rays are weighted;
                                 ///< renderers that state half of it (Cycles) call this 1.5
  int halvings = 0;  ///< the picture is of a photo that was halved so often; the filter's width is
                     ///< in pixels of the whole one
  bool smooth_normals = true;  ///< vertex normals: face normals weighted by the corner's angle
  bool cast_shadows = true;
  int visibility_rays = 64;  ///< per vertex, cosine-weighted hemisphere; 0: visibility 1
  bool derivatives = true;
  bool photo_derivative =
      true;  ///< false: Part::photo stays empty, and kBlur and kSpecular with it
  bool gloss_derivative = true;       ///< false: kSpecular of a body without gloss stays zero
  bool blur_derivative = true;        ///< false: kBlur stays zero
  bool vignetting_derivative = true;  ///< false: kVignetting stays zero
  bool uneven_derivative = true;      ///< false: Part::uneven stays empty
  bool centres = true;                ///< false: Rendering::triangle and uv stay empty
  bool parallel = false;              ///< on the cores of the caller's arena (oneTBB)
};

/// Derivative of one pixel by the vertices of one triangle. A pixel's derivative is the sum of its
/// segments (rays or silhouette edges on several triangles give several).
/// For vertex k of the triangle: d_position().col(k) by its deformed position, d_second().col(k) by
/// its unit vertex normal or, with Texture::Source::photo (which has no light), by its reference
/// position.
struct DerivativeSegment {
  using ByVertex = Eigen::Matrix<float, 6, 3>;
  ByVertex d = ByVertex::Zero();
  float zero[2] = {0, 0};  ///< eight numbers can be read from any column on
  int triangle = -1;
  auto d_position() { return d.topRows<3>(); }
  auto d_position() const { return d.topRows<3>(); }
  auto d_second() { return d.bottomRows<3>(); }
  auto d_second() const { return d.bottomRows<3>(); }
};

/// Derivative of one pixel by the photo's numbers: those before kUneven and zeros.
constexpr int kPhotoFloats = 16;
static_assert(kUneven <= kPhotoFloats);
using PhotoDerivative = Eigen::Matrix<float, kPhotoFloats, 1>;
/// The same by those from kUneven on.
using UnevenDerivative = Eigen::Matrix<float, kUnevenNumbers, 1>;

/// Pixels that count, with their derivatives, each in one of the parts. A part's rows are
/// compressed: the segments of its pixel i are segments[first[i] .. first[i+1]).
struct ImageDerivative {
  struct Part {
    std::vector<int> pixel;  ///< y*width + x
    std::vector<int> first;  ///< pixel.size() + 1
    std::vector<DerivativeSegment> segments;
    std::vector<PhotoDerivative> photo;    ///< as pixel; empty where not wanted
    std::vector<UnevenDerivative> uneven;  ///< the same; empty too of bodies without light
    void clear();
  };
  std::vector<Part> parts;
  size_t pixels() const;  ///< of all parts
  /// Calls f(i, pixel) with i counting over all parts.
  template <class F>
  void for_each_pixel(const F& f) const {
    size_t i = 0;
    for (const Part& part : parts)
      for (const int pixel : part.pixel) f(i++, pixel);
  }
};

struct Rendering {
  Image I;                          ///< 1 channel, linear
  Image coverage;                   ///< filtered fraction of the pixel that the body covers, 0..1
  std::vector<int> triangle;        ///< triangle under the pixel centre, -1: none
  std::vector<Eigen::Vector2f> uv;  ///< barycentric (of corners 1, 2) there
  ImageDerivative dI;               ///< of the *unblurred* picture times gain; see below
};

/// Blur and derivatives: with blur operator B (discrete Gaussian of the variance, Lindeberg 1990),
/// I = B I_sharp, so J^T w = J_sharp^T B^T w. `dI` holds J_sharp except column kBlur, which is
/// dI/dv of the blurred picture; apply blur() to the weighted residual before multiplying.
Image blur(const Image& image, double variance_px2);

/// Topology once, positions as often as wanted.
class Renderer {
 public:
  explicit Renderer(SurfaceMesh surface);  ///< triangles and uv are used; positions are the rest
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// `x` 3 x nv deformed positions; `x_reference` 3 x nv (photo texture; else may be null).
  /// `count` (per pixel, may be null): 0 = pixel not wanted.
  /// `silhouette`: background is told, so partly covered pixels count; otherwise only pixels fully
  /// covered (coverage > 1 - 1e-6) are active. With it, all pixels with coverage > 0 or a
  /// silhouette segment are active.
  Rendering render(const Matrix3Xd& x, const Matrix3Xd* x_reference, const Texture& texture,
                   const PhotoState& photo, const RenderOptions& options, bool silhouette,
                   const std::vector<unsigned char>* count = nullptr);
  /// The same in the memory of an earlier picture: tens of bytes a pixel that need not be asked
  /// for and cleared again.
  void render(const Matrix3Xd& x, const Matrix3Xd* x_reference, const Texture& texture,
              const PhotoState& photo, const RenderOptions& options, bool silhouette,
              const std::vector<unsigned char>* count, Rendering* out);

  /// Vertex normals (unit) of deformed positions and their linearisation:
  /// dn (3nv) = N dx (3nv), sparse.
  Matrix3Xd normals(const Matrix3Xd& x) const;
  Eigen::SparseMatrix<double, Eigen::RowMajor> normal_derivative(const Matrix3Xd& x) const;
  /// First visible hit: triangle and barycentric coordinates per pixel centre list.
  const SurfaceMesh& surface() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hookeye
