// What the page of `hookeye edit` is told of a capture.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "capture_io/partial_capture.h"
#include "meshing/surface_mesh.h"

namespace hookeye {

/// Units, cameras, regions, examples with their lines in the file, and the faults of reading.
nlohmann::json describe_partly(const PartialCapture& read);
/// [{file, line, column, wrong, right}]
nlohmann::json describe_faults(const PartialCapture& read);

/// The body's surface at rest, cut so fine that a region's edge is seen where it is.
struct ShownBody {
  SurfaceMesh surface;
  /// Triangle of the surface file each is cut from; where there is a volume alone, of its boundary.
  std::vector<int> parent;
  std::map<std::string, std::vector<int>> groups;  ///< of the volume: triangles as in `parent`
  bool of_file = false;                            ///< `parent` counts as `faces: FILE` does
};
/// Throws InputError: there is no body, or its files cannot be read.
ShownBody shown_body(const BodySpec& spec);
nlohmann::json describe_shown(const ShownBody& body);
/// What decides of a shown body: the same words, the same body.
std::string stamp_of(const BodySpec& spec);

/// Pixel and depth of each vertex; NaN where the camera cannot see it.
nlohmann::json describe_sight(const ShownBody& body, const Camera& camera);

/// Pictures of the folder and the folders in it, by their names there, at most a thousand.
nlohmann::json pictures_in(const std::filesystem::path& folder);

/// The photo as a PNG of sRGB grey, its longer side at most `most` pixels long.
std::string picture_of(const PhotoSpec& photo, int most);

}  // namespace hookeye
