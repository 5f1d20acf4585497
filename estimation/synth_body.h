// The body and the texture of a synthetic capture. Internal to synth.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "capture_io/image.h"
#include "estimation/recipe.h"
#include "meshing/surface_mesh.h"

namespace hookeye::detail {

/// A closed surface with an atlas: the wall unrolled, the two caps beside it.
struct SynthBody {
  SurfaceMesh surface;
  std::vector<int> grip, side;  ///< triangles of the top and of a patch of the wall at +x
  Eigen::Vector2d atlas;        ///< width and height of the atlas [length]
};
SynthBody make_shape(const Recipe& recipe);

/// Speckles: discs of random place and size with soft edges on a bright ground. 1 channel, linear.
Image make_texture(const Recipe& recipe, const SynthBody& body);

/// Random numbers of one purpose: the same for the same seed whatever else is drawn.
std::mt19937_64 random_of(unsigned seed, const std::string& purpose);
/// Uniform in [low, high), the same with every standard library.
double uniform(std::mt19937_64& random, double low, double high);

}  // namespace hookeye::detail
