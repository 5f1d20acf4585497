// The body and the texture of a synthetic capture. Internal to synth.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "capture_io/image.h"
#include "estimation/synth/recipe.h"
#include "meshing/surface_mesh.h"

namespace hookeye::detail {

/// A closed surface with texture coordinates and their picture, and its regions.
struct SynthBody {
  SurfaceMesh surface;
  Image albedo;  ///< linear
  std::vector<RegionSpec> regions;
  struct Patch {
    double area = 0.0;
    Vector3d centre = Vector3d::Zero();
  };
  std::map<std::string, Patch> patches;  ///< of all regions but `base`
};
/// A drawn shape: the wall unrolled, the two caps beside it, speckled; `base` its bottom, `grip`
/// its top, `side` a patch of the wall at +x. Or the recipe's own surface, with its own regions.
/// Throws InputError (place in the recipe) for what the surface cannot give.
SynthBody make_synth_body(const Recipe& recipe);

/// Random numbers of one purpose: the same for the same seed whatever else is drawn.
std::mt19937_64 random_of(unsigned seed, const std::string& purpose);
/// Uniform in [low, high), the same with every standard library.
double uniform(std::mt19937_64& random, double low, double high);

}  // namespace hookeye::detail
