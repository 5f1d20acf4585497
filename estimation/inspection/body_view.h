// The body as a camera sees it, small and quick: no derivatives, few rays, plain light.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "estimation/model/model.h"
#include "render/renderer.h"

namespace hookeye::inspection {

/// What gives the body its colour in a picture.
struct Paint {
  Texture texture;  ///< Texture::Source::uniform: shading alone
  bool shaded = false;
  double ambient = 1.0;
  UnevenLight uneven = UnevenLight::Zero();
  Vector3d sun = Vector3d::Zero();
};

struct BodyPicture {
  Image I;
  std::vector<unsigned char> body;        ///< per pixel: wholly covered
  std::vector<unsigned char> outline_of;  ///< per pixel: covered by half or more
  std::vector<int> triangle;        ///< of the render surface under the pixel's centre; -1: none
  std::vector<Eigen::Vector2f> uv;  ///< barycentric (of corners 1, 2) there
};

class BodyView {
 public:
  explicit BodyView(const Scene& scene);
  /// `x`: positions of the render surface's vertices; `x_reference`: those of the state that the
  /// painting photo shows (null: x).
  BodyPicture look(const Camera& camera, const Matrix3Xd& x, const Paint& paint,
                   const Matrix3Xd* x_reference = nullptr);

 private:
  Renderer renderer_;
  bool smooth_;
};

/// The told texture under the told light (light that is not told: even light). Empty: no picture is
/// told, or it is a photo. One colour shows shading alone, which any place of the body shows alike.
std::optional<Paint> told_paint(const Scene& scene, const PhotoState& state, int plane, int level);

/// Place in the camera's picture of the material point (triangle, uv) at positions `x`.
Vector2d place_of(const Camera& camera, const SurfaceMesh& surface, const Matrix3Xd& x,
                  int triangle, const Eigen::Vector2f& uv);

}  // namespace hookeye::inspection
