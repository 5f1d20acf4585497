#include "calibration/photographed.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/aruco.hpp>

namespace hookeye::test {

DrawnBoard charuco(int columns, int rows, const std::string& dictionary) {
  DrawnBoard drawn;
  drawn.board.columns = columns, drawn.board.rows = rows;
  drawn.board.pitch = 20, drawn.board.marker = 15, drawn.board.dictionary = dictionary;
  const auto number =
      std::ranges::find(marker_dictionaries(), dictionary) - marker_dictionaries().begin();
  const auto markers = cv::aruco::getPredefinedDictionary(static_cast<int>(number));
  const int side = markers->markerSize + 2;
  for (int id = 0; id < drawn.board.marker_count(); ++id) {
    cv::Mat picture;
    markers->drawMarker(id, side, picture);
    drawn.markers.emplace_back(picture.begin<uchar>(), picture.end<uchar>());
  }
  return drawn;
}

std::vector<CameraPhotos> photograph(const TemporaryFolder& folder, const DrawnBoard& drawn,
                                     const std::vector<Camera>& cameras,
                                     const std::vector<BoardPose>& poses, std::mt19937& random) {
  std::vector<CameraPhotos> photos;
  for (const Camera& camera : cameras) {
    const BoardPhotographer photographer(camera);
    for (size_t i = 0; i < poses.size(); ++i)
      write_image(folder / fmt::format("{}_{:02}.png", camera.name, i + 1),
                  photographer.photo(drawn, poses[i], {}, random), {Encoding::Kind::srgb});
    photos.push_back({camera.name, {(folder / (camera.name + "_*.png")).string()}});
  }
  return photos;
}

std::string refused(const Board& board, const std::vector<CameraPhotos>& photos) {
  try {
    calibrate(board, photos, {});
  } catch (const InputError& error) {
    return error.what();
  }
  return "it was taken";
}

}  // namespace hookeye::test
