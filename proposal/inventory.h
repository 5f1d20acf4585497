// What lies in a lab's folder: photos by camera and number, calibrations, meshes, tables.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "importers/importer.h"
#include "proposal/text_table.h"

namespace hookeye {

/// The photos of one camera.
struct PhotoSeries {
  std::string camera;  ///< as files or folder are called
  std::map<long, std::filesystem::path> photos;
  std::string scheme;  ///< "cam0_####.tif"
};

/// Files that an importer takes together.
struct CalibrationFile {
  const Importer* importer = nullptr;  ///< null: a cameras.yaml of `hookeye import` or `calibrate`
  Importer::Sources sources;
  /// "intrinsics.yml,extrinsics.yml", as seen from a folder.
  std::string name(const std::filesystem::path& folder) const;
};

struct Inventory {
  std::filesystem::path folder;  ///< absolute
  std::vector<PhotoSeries> series;
  std::vector<CalibrationFile> calibrations;
  std::vector<std::filesystem::path> surfaces, volumes;
  std::vector<TextTable> tables;        ///< of test machines
  std::vector<TextTable> other_tables;  ///< with names, but without force or travel
  std::vector<std::filesystem::path> videos;
  std::vector<std::filesystem::path> textures;  ///< pictures called albedo or texture
  std::vector<std::string> said;                ///< what was left out, and why
};

/// Looks at the names, and at the beginnings of what may be a calibration or a table. Folders of
/// runs, hidden ones and links are passed by. Throws InputError.
Inventory look_at(const std::filesystem::path& folder);

/// Photos by camera and number: the digits that run within names of one form are the number, what
/// tells names of one number apart is the camera; a folder a camera, where forms are alike.
/// Pictures that belong to no series are added to `left`.
std::vector<PhotoSeries> photo_series(const std::vector<std::filesystem::path>& pictures,
                                      std::vector<std::filesystem::path>& left);

}  // namespace hookeye
