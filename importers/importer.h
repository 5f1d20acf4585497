// Cameras of other programs, as cameras of a capture. One file a source, importers/NAME.cpp.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "capture_io/camera.h"
#include "core/input_error.h"

namespace hookeye {

/// A point that a camera saw, as its program says; reprojected where it is there.
struct SeenPoint {
  size_t camera = 0;  ///< index into Imported::cameras
  Eigen::Vector3d x;  ///< world [length of the source]
  Eigen::Vector2d pixel;
};

struct Imported {
  /// Distinct names; x_in_camera = R x_in_world + t [length of the source]. `width` 0: the source
  /// does not say.
  std::vector<Camera> cameras;
  std::vector<SeenPoint> seen;
  std::string world;              ///< where the world's frame stands: "the axes of cam0"
  std::vector<std::string> said;  ///< what the user is to know
};

struct ImportOptions {
  int width = 0, height = 0;    ///< [px] of cameras whose source does not say; 0: not told
  double scale = 1.0;           ///< length units of the capture in one of the source
  bool lens_as_opencv = false;  ///< coefficients of unpublished models are k1 k2 k3 p1 p2 of OpenCV
};

/// One source. Has no state and lives as long as the program.
///
/// A new one is a file importers/NAME.cpp that ends with HOOKEYE_DEFINE_IMPORTER(NAME, Class), and
/// the line HOOKEYE_IMPORTER(NAME) in importers/catalogue.def.
class Importer {
 public:
  using Sources = std::vector<std::filesystem::path>;
  virtual ~Importer() = default;
  virtual std::string name() const = 0;   ///< KIND of the command
  virtual std::string title() const = 0;  ///< what it reads, for people
  /// Whether the sources look like its own: by their names and first bytes. Never throws.
  virtual bool recognises(const Sources& sources) const = 0;
  /// Throws InputError, with the line where there is one. Sizes, names and lenses are checked by
  /// import_cameras().
  virtual Imported read(const Sources& sources, const ImportOptions& options) const = 0;
};

/// All of the catalogue.
const std::vector<const Importer*>& importers();
/// By its name; null where there is none.
const Importer* find_importer(const std::string& name);
/// The one that recognises the sources. Throws InputError.
const Importer& recognise(const Importer::Sources& sources);

/// Reads the sources and applies the options; what comes out is accepted by a capture. Throws
/// InputError.
Imported import_cameras(const Importer& importer, const Importer::Sources& sources,
                        const ImportOptions& options);
/// The text of cameras.yaml.
std::string cameras_yaml(const Imported& imported, const std::string& head);
/// Root mean square of |project(x) - pixel| a camera [px], and how many points each saw.
struct Reprojection {
  double rms_px = 0;
  size_t points = 0;
};
std::vector<Reprojection> reproject(const Imported& imported);

}  // namespace hookeye

#define HOOKEYE_DEFINE_IMPORTER(NAME, CLASS) \
  namespace hookeye {                        \
  const Importer& importer_##NAME() {        \
    static const CLASS importer;             \
    return importer;                         \
  }                                          \
  }
