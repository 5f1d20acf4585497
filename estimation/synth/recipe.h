// What a synthetic capture is made from: docs/synth.md. Lengths, forces and motions of the examples
// are told in units of the body, so that one list of examples serves every size and stiffness.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture_io/capture.h"
#include "meshing/surface_mesh.h"

namespace hookeye {

/// A body that stands on z = 0: flat bottom and top, walls between them. Or a surface of a file,
/// wherever it lies.
struct ShapeRecipe {
  enum class Kind { block, cylinder, blob, surface } kind = Kind::block;
  Vector3d size{30.0, 24.0, 60.0};  ///< [length]; of a surface its bounding box
  NamedFile file;                   ///< the surface's
  std::shared_ptr<const SurfaceMesh> surface;
  bool own() const { return kind == Kind::surface; }
  /// What the rig's distances and heights count in: the height, of a surface its longest side.
  double height() const { return own() ? size.maxCoeff() : size.z(); }
  double taper = 1.0;  ///< width at the top over width at the bottom
  double bumps = 0.0;  ///< largest bump of the wall over the smaller width
  double facet = 0.0;  ///< edge of the surface's triangles [length]
};

struct TextureRecipe {
  double texel = 0.0;    ///< [length]
  double speckle = 0.0;  ///< mean diameter of a speckle [length]
  double cover = 0.5;    ///< share of the surface that speckles cover
  double soft = 0.35;    ///< width of a speckle's edge over its mean diameter
  double dark = 0.2, bright = 0.8;
  /// A picture in the surface's own texture coordinates instead of speckles; empty: none.
  NamedFile image;
  std::optional<Encoding> encoding;
  Place place;
};

struct CameraRecipe {
  int count = 2;
  int width = 480, height = 360;  ///< [px]
  double distance = 5.0;          ///< from the point looked at, in body heights
  double focal = 0.0;             ///< [px]
  std::vector<std::string> projection{"perspective"};      ///< names of camera models, in turn
  std::vector<double> distortion;                          ///< of all whose rays meet in a point
  double vignetting = 0.0;                                 ///< the same
  double azimuth = 20.0, spread = 70.0, elevation = 15.0;  ///< [degrees]
  double look_at = 0.5;                   ///< height of the point looked at, in body heights
  std::optional<Vector3d> look_at_point;  ///< of a surface; empty: the middle of its bounding box
  Place place;
};

struct MaterialRecipe {
  MaterialSpec truth, told;
  std::vector<std::string> fit;
};

struct ExampleRecipe {
  std::string name;
  Place place;
  bool validate = false, test = false;
  std::string region = "grip";
  std::optional<Vector3d> force;  ///< in shear modulus times area of the grip; of a surface [force]
  std::optional<Vector3d> move;   ///< rigid, in body heights; of a surface [length]
  double rotate_degrees = 0.0;    ///< rigid, about `axis` through the region's centroid
  Vector3d axis = Vector3d::UnitZ();
  bool moves() const { return move.has_value() || rotate_degrees != 0.0; }
};

/// One effect that the capture does not tell.
struct HiddenRecipe {
  struct Value {
    double number;
    Place place;
  };
  std::string effect, variant;
  bool drawn = true;                    ///< `values` left out: drawn by the seed, like `variant`
  std::map<std::string, Value> values;  ///< what is not named stays at its null
  /// Values are scaled in common until they move the pictures by this much; empty: as they are.
  std::optional<double> rms_px;
  /// On the values' distance from their nulls: the size of what moves nothing (light, exposure),
  /// and where the scaling by `rms_px` starts.
  double times = 1.0;
  Place place, variant_place, values_place;
};

struct NoiseRecipe {
  double full_well = 20000.0;  ///< electrons at full scale
  double read = 0.001;         ///< [full scale]
  int bits = 8;
  double force = 0.003;  ///< sigma in shear modulus times area of the grip, of a surface the region
  double moment = 0.003;  ///< the same, times the body's height
};

/// What the capture has of each photo.
struct PhotoRecipe {
  /// Coverage of a pixel above which it is the body's: black and white silhouettes, without
  /// texture. Empty: pictures.
  std::optional<double> silhouette;
  Place place;
};

/// How the truth is computed: never as the fit will.
struct TruthRecipe {
  double edge_factor = 0.7;  ///< edge of the truth's tetrahedra over the told one
  int order = 2;
  int rays_per_axis = 5;
  int visibility_rays = 256;
};

struct Recipe {
  std::filesystem::path file;
  std::string text;  ///< the file's content: goes into the truth file
  std::string title;
  unsigned seed = 1;
  Units units{"mm", "N"};
  ShapeRecipe shape;
  std::vector<RegionSpec> regions;  ///< of a surface, `base` among them; a shape has its own
  double density = 0.0;             ///< told; 0: not
  std::optional<Vector3d> gravity;  ///< told, and acting in all examples [length/s^2]
  double edge = 0.0;                ///< told `mesh:` [length]
  int order = 2;
  TextureRecipe texture;
  MaterialRecipe material;
  CameraRecipe cameras;
  LightSpec light;
  std::vector<ExampleRecipe> examples;
  std::vector<HiddenRecipe> hidden;
  NoiseRecipe noise;
  PhotoRecipe photos;
  TruthRecipe truth;
};

/// Throws InputError with the place of the first fault.
Recipe read_recipe(const std::filesystem::path& file);
/// The same from text; `name` stands in places.
Recipe parse_recipe(const std::string& text, const std::string& name);

}  // namespace hookeye
