// How much of a photo a fit looks at. Photos of many megapixels tell the same thing many times
// over: cost is to follow what they tell.
#pragma once

#include <map>
#include <string>

#include "capture_io/capture.h"
#include "estimation/model/limits.h"
#include "meshing/surface_mesh.h"

namespace hookeye {

/// A rectangle of pixels. Empty: nothing.
struct PhotoWindow {
  int x = 0, y = 0, width = 0, height = 0;
  bool empty() const { return width <= 0 || height <= 0; }
  /// The smallest that holds both.
  PhotoWindow with(const PhotoWindow& other) const;
};

/// How the photos of one camera are read.
struct PhotoReading {
  int halvings = 0;    ///< each takes the mean of two by two pixels
  double share = 1.0;  ///< of the tiles (kTile) of a photo that count, drawn at random
  double kept = 1.0;   ///< of what its photos tell of motion (Fisher information), by the halvings
  double body_px = 0;  ///< pixels of the body at rest that count in a photo then
  /// Of the halved photo; empty: all of it. What lies beyond stands still in all photos of the
  /// camera and is not the body.
  PhotoWindow window;
  int taken_width = 0, taken_height = 0;  ///< [px] of the photo as the camera took it
  /// Some of what the camera took of the body does not count by itself.
  bool in_part() const { return halvings > 0 || share < 1.0; }
  bool for_memory = false;  ///< the last halvings were for want of it
  bool whole() const { return halvings == 0 && share == 1.0 && window.empty(); }
};

/// By camera; those whose photos are read as they are have none.
using PhotoReadings = std::map<std::string, PhotoReading>;

constexpr int kTile = 64;  ///< side of a tile [px of the read photo]

/// Such that the body has at most limits.pixels pixels that count. First by halving, as long as
/// limits.pixels_keep of the information stays; then by tiles. `photo`: one of the camera's.
PhotoReading reading_of(const Photo& photo, const Camera& camera, const SurfaceMesh& surface,
                        const FitLimits& limits);

/// Halved further as long as `bytes` are too few for so many photos of the camera. `planes`: of a
/// photo.
PhotoReading within_memory(PhotoReading reading, const Camera& camera, const SurfaceMesh& surface,
                           double photos, double planes, double bytes);
/// What a photo of so many pixels takes while it is decoded, and weighed [bytes].
double decoding_bytes(const Camera& camera);

/// Information of a motion along either axis that a plane has after so many halvings, per square
/// pixel of the whole photo: sums of squared slope over variance, less what noise adds to the
/// slope.
double told_of_motion(const Photo& photo, int plane, int halvings);

/// Where the body at rest is, in px of the halved photo.
PhotoWindow window_of_body(const Camera& camera, const SurfaceMesh& surface, int halvings);
/// Where two halved photos of one camera differ by more than noise.
PhotoWindow changed_between(const Photo& one, const Photo& other);
/// With room for what moves next and for filters, within the picture; empty where little is left
/// out.
PhotoWindow with_margin(const PhotoWindow& window, int width, int height);

Camera as_read(const Camera& camera, const PhotoReading& reading);
/// The other way round, where it stands now: of the taken photo cut to the same window.
Camera as_taken(const Camera& read, const PhotoReading& reading);
/// `name`: the draw of tiles, another for each photo.
Photo as_read(Photo photo, const PhotoReading& reading, const std::string& name);

/// The part of a picture that the window shows.
Image cut(const Image& image, const PhotoWindow& window);
/// The same of all of a photo's; a window that is empty or not within it cuts nothing.
void cut(Photo& photo, const PhotoWindow& window);

/// "photos of camera left are read at 1/2 of their width ..."
std::string described(const std::string& camera, const PhotoReading& reading);

}  // namespace hookeye
