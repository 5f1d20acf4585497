// Which photos there are, of which camera, and which were taken at one instant.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hookeye {

struct CameraPhotos {
  std::string name;
  std::vector<std::string>
      sources;  ///< files, folders, or patterns with * and ? in the file's name
};

struct BoardPhoto {
  std::filesystem::path file;
  size_t camera = 0;
  size_t instant = 0;  ///< the board stands alike in all photos of an instant
};

struct PhotoList {
  std::vector<BoardPhoto> photos;          ///< by camera, then by instant
  std::vector<std::string> instants;       ///< their names, for people: "0012", or the photo's name
  std::vector<std::pair<int, int>> sizes;  ///< of each camera [px]
  std::vector<std::string> said;           ///< how photos were paired
};

/// Photos of several cameras are paired by the last number in their names; where that does not go,
/// by their order if there are as many of each. Throws InputError: nothing found, unreadable, a
/// size unlike the camera's others, pairs that cannot be told.
PhotoList list_photos(const std::vector<CameraPhotos>& cameras);

}  // namespace hookeye
