// What cameras and measured fields see of the surface, point by point, in the terms of image
// correlation: displacements and strains of the model, and those of the photos. For exporters of
// fields (dic).
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/evaluation/evaluation.h"
#include "exporters/surface_strain.h"

namespace hookeye {

struct SeenOptions {
  int grid_px = 16;                 ///< from point to point in the picture of the body at rest
  int window = 5;                   ///< points along a side of the strain window, odd
  std::vector<std::string> gauges;  ///< regions; empty: all of the capture
  std::vector<std::array<Vector3d, 2>> lines;  ///< from rest point to rest point [length]
  std::optional<Vector3d> along;  ///< direction of exx in the body's frame, laid into the surface
};

/// Points of one camera or of one field in one load case. Columns and entries by point.
struct SeenPoints {
  std::string view;      ///< name of the camera, or of the field's file
  bool camera = true;    ///< else a field
  std::string from;      ///< of a field that starts from a load case: X is there, u leads on
  double spacing = 0.0;  ///< from point to point on the body, in the middle [length]
  Eigen::Matrix2Xd px;   ///< in the whole picture of the body at rest; of a field empty
  Matrix3Xd X, u;        ///< at rest, and the model's displacement [length]
  std::vector<SurfacePoint> points;
  std::vector<Tangents> tangents;  ///< exx is along the first of them
  std::vector<SurfaceStrain> strain;
  /// Photo less model: displacement that removes the residual [length]. NaN: not known. Of one
  /// camera it is across the line of sight, as nothing tells of the motion along it.
  Matrix3Xd apart;
  VectorXd sigma;          ///< of a component of it, where noise is as told [length]
  std::vector<int> known;  ///< how many directions of it are known, 0 to 3
  /// Of model and residual together, over a window; empty where too few points are known.
  std::vector<std::optional<SurfaceStrain>> strain_seen;
  int size() const { return static_cast<int>(X.cols()); }
  bool has_apart(int i) const { return known[static_cast<size_t>(i)] > 0; }
};

/// Mean over a region.
struct Gauge {
  std::string name;
  Vector3d along = Vector3d::UnitX();   ///< what exx is along, before it is laid into the surface
  SurfaceStrain strain;                 ///< of the model, by area
  std::optional<SurfaceStrain> seen;    ///< of the photos: mean of their points in the region
  std::optional<SurfaceStrain> differ;  ///< the model's mean over those same points
  int points = 0;                       ///< how many these are
};
/// An extensometer, and what is along it.
struct Line {
  std::string name;
  std::array<Vector3d, 2> ends;       ///< the told ones, on the surface
  double rest = 0, length = 0;        ///< from end to end [length]
  std::optional<double> seen;         ///< the same of the photos
  Matrix3Xd X, u;                     ///< along it, evenly spaced, laid onto the surface
  std::vector<SurfaceStrain> strain;  ///< exx is along the line
};

struct SeenCase {
  std::string name;
  std::string use;    ///< fit, validate
  bool rest = false;  ///< nothing strains the body
  std::vector<SeenPoints> views;
  std::vector<Gauge> gauges;
  std::vector<Line> lines;
};

struct SeenSurface {
  SeenOptions options;
  int cell_px = 16;  ///< cells in which motions between photo and model are found [px as read]
  std::shared_ptr<const Scene> scene;
  std::vector<SeenCase> cases;  ///< those that were evaluated
};

/// `evaluation`: of `model`, with pictures. Throws InputError for a region that is none.
SeenSurface seen_surface(const Model& model, const Evaluation& evaluation,
                         const SeenOptions& options);

/// Gauges and lines of a case whose views are there.
void add_gauges(const Model& model, const VectorXd& q, const SeenOptions& options, SeenCase& out);

/// Root mean square over the cases at rest: of a component of `apart` [length] (`strain` false), or
/// of a component of the photos' strain less the model's. Empty: no photo at rest tells.
std::optional<double> noise_floor(const SeenSurface& seen, const std::string& view, bool strain);

}  // namespace hookeye
