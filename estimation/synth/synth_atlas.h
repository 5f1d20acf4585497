// Texture of a synthetic body whose surface has none: an atlas of its triangles, speckled in space.
// Internal to synth.
#pragma once

#include <random>

#include "capture_io/image.h"
#include "estimation/synth/recipe.h"
#include "meshing/surface_mesh.h"

namespace hookeye::detail {

/// Grey that speckles give to points of a surface: balls of random size around random points of it
/// with soft edges, on a bright ground. Nothing is stretched, and no seam is seen.
class Speckles {
 public:
  Speckles(const TextureRecipe& texture, const SurfaceMesh& surface, std::mt19937_64 random);
  float at(const Vector3d& X) const;

 private:
  struct Ball {
    Vector3d centre;
    double radius, grey;
  };
  std::array<int, 3> cell_of(const Vector3d& X) const;
  double bright_, soft_, cell_ = 0.0;
  std::vector<Ball> balls_;
  std::map<std::array<int, 3>, std::vector<int>> near_;  ///< balls that reach into a cell
};

/// Texture coordinates for the surface, and its picture in them: patches of triangles that face the
/// same side of a cube, each seen from that side. 1 channel, linear. Throws InputError (place of
/// the texture) where the picture would be too large.
Image speckled_atlas(const Recipe& recipe, SurfaceMesh& surface);

}  // namespace hookeye::detail
