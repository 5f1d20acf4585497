// A capture as the user wrote it, validated; immutable after read_capture(). Format:
// docs/capture.md.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "capture_io/camera.h"
#include "capture_io/image.h"
#include "capture_io/light_harmonics.h"
#include "core/input_error.h"
#include "core/shared_value.h"

namespace hookeye {

using Eigen::Vector3d;
using Eigen::VectorXd;

struct CameraCovariance;  // camera_covariance.h

/// Names only; numbers in the capture are never converted.
struct Units {
  std::string length, force;   ///< "mm" | "m" | "cm" ..., "N" | "mN" | "kN"
  std::string stress() const;  ///< "MPa" for mm and N, "Pa" for m and N, else "N/cm^2" style
  std::string acceleration() const { return length + "/s^2"; }
  /// Factor from SI acceleration m/s^2 to length/s^2.
  double metre() const;  ///< length units in one metre (1000 for mm)
};

struct RegionSpec {
  struct Box {
    Vector3d low, high;
  };
  struct Faces {
    std::filesystem::path file;
    std::vector<int> triangles;
    std::string told;                         ///< the file's name for messages
    std::vector<std::array<int, 2>> told_at;  ///< line and column of each triangle; may be empty
  };
  struct Sphere {
    Vector3d center;
    double radius;
  };
  struct Halfspace {
    Vector3d point, normal;
  };  ///< (x - point).normal >= 0
  struct Group {
    std::string name;
  };
  std::string name;
  Place place;
  std::variant<Box, Faces, Sphere, Halfspace, Group> shape;
};

/// `law: name` with its numbers; the simulation's registry checks names, counts and ranges and
/// reports with these places.
struct MaterialSpec {
  struct Value {
    std::vector<double> numbers;
    Place place;
  };
  std::string law;
  Place place;
  std::map<std::string, Value> parameters;  ///< "mu" -> {0.05}
  std::string region;  ///< "" = the whole body, else a group of the volume, or of `blend` the name
  /// Weight of the law over the body: piecewise linear along a direction of rest coordinates,
  /// constant beyond its ends.
  struct Blend {
    Eigen::Vector3d along;           ///< unit
    std::vector<double> at, weight;  ///< rising places [length]; >= 0
    double of(const Eigen::Vector3d& X) const;
  };
  std::optional<Blend> blend;
};

struct BodySpec {
  std::filesystem::path surface, volume;  ///< absolute; either may be empty
  Place surface_place, volume_place;
  double edge = 0.0;  ///< target edge [length]; 0: not given
  int order = 2;
  bool mesh_given = false;  ///< `mesh:` stands in the capture
  double density = 0.0;     ///< [force s^2 / length^4]; 0: not given
  enum class Texture { none, image, rest, uniform } texture = Texture::none;
  NamedFile texture_image;
  std::optional<Encoding> texture_encoding;
  std::string texture_example;           ///< of `from: NAME`
  std::optional<double> uniform_albedo;  ///< empty with Texture::uniform: fitted
  bool fit_placement = false;
  bool flat_shading = false;  ///< shading: flat (default smooth)
  Place place, texture_place;
};

struct LightSpec {
  double ambient = 1.0;
  UnevenLight uneven = UnevenLight::Zero();  ///< of `harmonics`, whose L00 is in `ambient`
  Vector3d sun = Vector3d::Zero();           ///< strength times unit vector towards the sun
  bool given = false;                        ///< false: absent or `harmonics: fit`, to be fitted
  bool fit_harmonics = false;                ///< `harmonics: fit`; the sun is told
};

struct RigidMotion {
  Vector3d axis = Vector3d::UnitZ();
  double degrees = 0.0;
  Vector3d center = Vector3d::Zero();
  Vector3d move = Vector3d::Zero();
  Vector3d apply(const Vector3d& X) const;  ///< rotate about center, then move
  /// Share s of it: s times the angle, s times the move.
  RigidMotion part(double s) const { return {axis, s * degrees, center, s * move}; }
};

struct SupportSpec {
  enum class Kind { components, rigid, rigid_fit } kind = Kind::components;
  std::string region;
  Place place;
  std::array<std::optional<double>, 3> displacement;  ///< Kind::components; fix = 0
  RigidMotion rigid;                                  ///< Kind::rigid
};

struct LoadSpec {
  std::string region;
  Place place;
  std::optional<Vector3d> force;   ///< total dead force, uniform over the rest area
  std::optional<double> pressure;  ///< follows the deformed normal, pushes inwards
};

struct BackgroundSpec {
  enum class Kind { ignore, level, fit, photo } kind = Kind::ignore;
  double level = 0.0;  ///< black = 0
  std::filesystem::path photo;
};

struct PhotoSpec {
  std::string camera;
  std::filesystem::path file, mask;
  enum class Kind { image, silhouette } kind = Kind::image;
  std::optional<Encoding> encoding;
  std::optional<NoiseModel> noise;  ///< empty: estimated
  bool rgb = false;                 ///< channels: rgb; default luminance
  BackgroundSpec background;        ///< the photo's own, else that of `photos:`
  Place place;
};

struct StrainSpec;  // strain_field.h

/// Displacements or strains of points of the surface, as programs for digital image correlation
/// write them.
struct FieldSpec {
  std::filesystem::path file;
  std::string told;        ///< the file's name for messages
  Eigen::Matrix3Xd X;      ///< the points on the body as it was given [length]
  std::vector<int> lines;  ///< of the file, by point
  /// Columns: what the components are along, in the capture's frame. Of two the last is not
  /// measured.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  int components = 3;
  /// What strains it holds, of exx, eyy and (of three components) exy; null: displacements.
  std::shared_ptr<const StrainSpec> strain;
  std::string strain_columns;  ///< of the file, where displacements are read; "": it has none
  double sigma = 0.0;          ///< told standard deviation of a component [length; of strains 1]
  double spacing = 0.0;        ///< middle distance from point to next point [length]
  double correlation = 0.0;    ///< side of the patch whose points err alike [length]; 0: none do
  bool correlation_told = false;
  bool unit_told = false;  ///< by the capture or by the file; else it is taken for the capture's
  double tolerance = 0.0;  ///< how far a point may lie off the surface [length]; 0: not told
  int dropped = 0;         ///< rows without numbers, or that the file itself marks as bad
  VectorXd alike;          ///< by point: how many points err as it does, itself included
  /// Pieces of the surface some patches wide, by point: noise that hangs together farther than is
  /// told shows in their sums.
  std::vector<int> piece;
  int pieces = 1;
  Eigen::Matrix3Xi piece_at;  ///< by piece: where it is, in edges of a piece
  /// Independent numbers in it: those that err alike count as one.
  double numbers() const { return components * alike.cwiseInverse().sum(); }
  /// Of residuals over MeasuredSpec::sigma, point by point: variance of their sum over a piece,
  /// over what numbers() says of it; at least 1.
  double inflation(const VectorXd& r) const;
  /// How many of numbers() count where residuals hang together over the surface, by the
  /// autocorrelation of these: numbers() over the sum of its squares over all lags.
  double effective(const VectorXd& r) const;
};

struct MeasuredSpec {
  enum class Kind {
#define MEASURED(kind, on, key, size, unit, words) kind,
#include "capture_io/measured_kinds.def"
#undef MEASURED
  } kind;
  std::string region;                     ///< where it is measured on a region
  Vector3d point = Vector3d::Zero();      ///< where it is measured at one: rest position
  Vector3d direction = Vector3d::Zero();  ///< moment: about this point; travel, rotation: unit
                                          ///< vector; strain: the other point's rest position
  Eigen::VectorXd value;  ///< told numbers; angles in degrees; of a field point by point
  Eigen::VectorXd sigma;  ///< their standard deviations; of a field times the root of `alike`
  std::shared_ptr<const FieldSpec> field;  ///< of Kind::field
  /// Lower triangle L of their covariance L L^T; empty: they are independent.
  Eigen::MatrixXd covariance_root;
  Place place;

  /// (predicted - value), or a column of its derivative, in standard deviations.
  Eigen::MatrixXd whitened(Eigen::MatrixXd difference) const;
};

/// What a kind of measurement is.
struct MeasuredKind {
  const char* name;   ///< key of the capture: "force_on"
  const char* on;     ///< "region", "point", "points" (two), "file", "cameras"
  const char* key;    ///< further key; "none"
  int size;           ///< numbers; 0: as many as the file has
  const char* unit;   ///< "force", "moment", "length", "angle", "strain", "deviations"
  const char* words;  ///< "force on"
};
const MeasuredKind& kind_of(const MeasuredSpec& measured);
/// A field of strains.
bool is_strain_field(const MeasuredSpec& measured);
/// It tells a force or a moment of a support.
bool is_reaction(const MeasuredSpec& measured);
/// It tells something of the body, not of what looks at it.
bool is_on_body(const MeasuredSpec& measured);
/// "N", "N mm", "mm", "degrees", "" (strains), "sigma" (deviations).
std::string unit_of(const MeasuredSpec& measured, const Units& units);

struct ExampleSpec {
  std::string name;
  Place place;
  bool validate = false;  ///< use: validate, or test: not fitted
  bool test = false;      ///< use: test: no fit, score, order or stop sees it
  const char* use() const { return test ? "test" : validate ? "validate" : "fit"; }
  std::vector<SupportSpec> supports;
  std::vector<LoadSpec> loads;
  std::vector<PhotoSpec> photos;
  std::vector<MeasuredSpec> measured;
};

struct Capture {
  std::filesystem::path file, folder;  ///< absolute path of capture.yaml and of its folder
  std::string title;
  Units units;
  BodySpec body;
  std::vector<MaterialSpec> materials;
  std::vector<std::string> fit;  ///< material parameters that may move
  std::vector<Place> fit_places;
  std::optional<Vector3d> gravity;  ///< [length/s^2]
  std::vector<Camera> cameras;
  /// How well their numbers are known; null: as told. Then a fitted example measures it.
  std::shared_ptr<const CameraCovariance> camera_covariance;
  LightSpec light;
  std::vector<RegionSpec> regions;
  std::vector<ExampleSpec> examples;

  const Camera& camera(const std::string& name) const;
  const RegionSpec* region(const std::string& name) const;
};

/// Reads `path` (the yaml file or its folder), every referenced header included (sizes, existence,
/// no path out of the folder), but not the pixels. Throws InputError at the first fault found.
/// Limits against hostile files: 16 MiB of yaml, no alias expansion beyond 10,000 nodes.
Capture read_capture(const std::filesystem::path& path);

/// A photo with its pixels, ready to compare: one plane per compared channel (1 or 3).
struct Photo {
  std::string camera;
  PhotoSpec::Kind kind = PhotoSpec::Kind::image;
  std::vector<SharedValue<Image>> planes;  ///< 1-channel, linear; luminance unless rgb
  std::vector<SharedValue<Image>> sigma;   ///< 1-channel, same shape: noise standard deviation,
                                           ///< from the mean of the pixel's neighbours
  SharedValue<std::vector<unsigned char>> valid;  ///< per pixel: 0 masked out (or saturated), 1
                                                  ///< counts
  std::vector<SharedValue<Image>> backdrop;       ///< the planes of background: {photo}, else empty
  NoiseModel noise;
  std::vector<double> channel_weights;  ///< planes[k] = channel k (rgb) or the luminance weights
};
Photo read_photo(const PhotoSpec& spec, const Camera& camera);

}  // namespace hookeye
