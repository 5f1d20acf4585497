// The only file that touches OpenCV's calib3d and aruco: boards found in photos, and a first guess
// of a camera. A program of its own.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/board.h"
#include "calibration/helpers/saddle.h"
#include "calibration/helpers/tag_edges.h"
#include "core/helper_main.h"
#include "core/input_error.h"

namespace hookeye {
namespace {

using Points = std::vector<cv::Point2f>;

struct Found {
  std::map<int, cv::Point2f> corners;
  std::string why;
  size_t markers = 0;  ///< of a ChArUco board: those in their places
};

cv::Ptr<cv::aruco::Dictionary> dictionary_of(const std::string& name) {
  const auto at = std::ranges::find(marker_dictionaries(), name) - marker_dictionaries().begin();
  return cv::aruco::getPredefinedDictionary(static_cast<int>(at));
}

// ---- ChArUco ----

using Markers = std::map<int, Points>;

std::vector<std::pair<int, Points>> all_markers_in(const cv::Mat& grey,
                                                   const std::string& dictionary) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->minMarkerPerimeterRate = 0.01;  // boards far away
  // Their windows would hold the board's own corner, which lies near, and be drawn to it.
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  std::vector<Points> corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(grey, dictionary_of(dictionary), corners, ids, parameters);
  std::vector<std::pair<int, Points>> markers;
  for (size_t i = 0; i < ids.size(); ++i) markers.emplace_back(ids[i], corners[i]);
  return markers;
}

Markers markers_in(const cv::Mat& grey, const std::string& dictionary) {
  Markers markers;
  for (const auto& [id, corners] : all_markers_in(grey, dictionary)) markers[id] = corners;
  return markers;
}

/// Where markers lie on the board: on the white squares, row by row. Of boards with an even number
/// of rows there are two kinds: OpenCV before 4.7 began them with a white square.
struct Layout {
  std::vector<Points> corners;            ///< [length], of each marker
  std::map<std::pair<int, int>, int> at;  ///< square (column, row) -> marker
};

Layout layout_of(const Board& board, bool white_first) {
  Layout layout;
  const auto pitch = static_cast<float>(board.pitch), side = static_cast<float>(board.marker);
  for (int row = 0; row < board.rows; ++row)
    for (int column = 0; column < board.columns; ++column) {
      if ((row + column) % 2 == (white_first ? 1 : 0)) continue;
      const float x = static_cast<float>(column) * pitch + (pitch - side) / 2;
      const float y = static_cast<float>(row) * pitch + (pitch - side) / 2;
      layout.at[{column, row}] = static_cast<int>(layout.corners.size());
      layout.corners.push_back({{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}});
    }
  return layout;
}

/// The markers that lie as on a plane board of this layout, to a third of a marker: lenses bend.
Markers fitting(const Markers& seen, const Layout& layout) {
  Points on_board, in_photo;
  double side = 0.0;
  for (const auto& [id, corners] : seen) {
    if (id >= static_cast<int>(layout.corners.size())) continue;
    const Points& flat = layout.corners[static_cast<size_t>(id)];
    on_board.insert(on_board.end(), flat.begin(), flat.end());
    in_photo.insert(in_photo.end(), corners.begin(), corners.end());
    side += cv::norm(corners[1] - corners[0]) + cv::norm(corners[2] - corners[1]);
  }
  if (on_board.size() < 8) return {};
  const double limit = side / (static_cast<double>(on_board.size()) / 2) / 3;
  const cv::Mat H = cv::findHomography(on_board, in_photo, cv::RANSAC, limit);
  if (H.empty()) return {};
  Markers good;
  for (const auto& [id, corners] : seen) {
    if (id >= static_cast<int>(layout.corners.size())) continue;
    Points expected;
    cv::perspectiveTransform(layout.corners[static_cast<size_t>(id)], expected, H);
    double worst = 0.0;
    for (size_t k = 0; k < 4; ++k) worst = std::max(worst, cv::norm(expected[k] - corners[k]));
    if (worst < 2 * limit) good[id] = corners;
  }
  return good;
}

/// A corner of the board lies between two markers; both tell where it is.
void corners_between(const cv::Mat& grey, const Board& board, const Layout& layout,
                     const Markers& markers, Found& found) {
  for (int id = 0; id < board.corner_count(); ++id) {
    const int column = id % board.corner_columns(), row = id / board.corner_columns();
    const Eigen::Vector3d place = board.corner(id);
    const Points on_board{{static_cast<float>(place.x()), static_cast<float>(place.y())}};
    cv::Point2f mean(0, 0);
    double nearest = 1e9;
    int count = 0;
    Points around;
    for (int k = 0; k < 4; ++k) {
      const auto square = layout.at.find({column + k % 2, row + k / 2});
      if (square == layout.at.end()) continue;
      const auto marker = markers.find(square->second);
      if (marker == markers.end()) continue;
      const cv::Mat H = cv::getPerspectiveTransform(
          layout.corners[static_cast<size_t>(square->second)], marker->second);
      Points expected;
      cv::perspectiveTransform(on_board, expected, H);
      mean += expected[0];
      around.insert(around.end(), marker->second.begin(), marker->second.end());
      ++count;
    }
    if (count < 2) continue;
    mean /= static_cast<float>(count);
    for (const cv::Point2f& corner : around) nearest = std::min(nearest, cv::norm(corner - mean));
    // The markers' own corners, and their blur, stay outside in any turn of the board.
    const int reach = std::clamp(static_cast<int>(nearest) - 2, 2, kFarthest);
    if (refine(grey, reach, mean)) found.corners[id] = mean;
  }
}

Found find_charuco(const cv::Mat& grey, const Board& board) {
  Found found;
  const Markers seen = markers_in(grey, board.dictionary);
  if (seen.empty()) return {{}, fmt::format("no marker of {} seen", board.dictionary)};
  const auto outside = static_cast<size_t>(std::ranges::count_if(
      seen, [&](const auto& marker) { return marker.first >= board.marker_count(); }));
  Layout layout = layout_of(board, false);
  Markers good = fitting(seen, layout);
  if (board.rows % 2 == 0) {
    Layout other = layout_of(board, true);
    if (Markers better = fitting(seen, other); better.size() > good.size())
      good = std::move(better), layout = std::move(other);
  }
  if (2 * outside > seen.size())
    found.why = fmt::format("markers up to number {} seen, the board has 0 to {}",
                            seen.rbegin()->first, board.marker_count() - 1);
  else if (seen.size() - outside > 3 && 2 * good.size() < seen.size() - outside)
    found.why = fmt::format("{} markers seen, but not in the places of a {}x{} board", seen.size(),
                            board.columns, board.rows);
  else
    corners_between(grey, board, layout, good, found), found.markers = good.size();
  return found;
}

// ---- chessboards and dots ----

/// Corners in rows: turned over where they came as in a mirror.
Found in_rows(const Board& board, Points corners) {
  const int columns = board.corner_columns(), rows = board.corner_rows();
  const auto at = [&](int column, int row) -> cv::Point2f& {
    return corners[static_cast<size_t>(row * columns + column)];
  };
  const cv::Point2f along = at(columns - 1, 0) - at(0, 0), down = at(0, rows - 1) - at(0, 0);
  if (along.cross(down) < 0)
    for (int row = 0; row < rows; ++row) std::reverse(&at(0, row), &at(0, row) + columns);
  Found found;
  for (int id = 0; id < board.corner_count(); ++id)
    found.corners[id] = corners[static_cast<size_t>(id)];
  return found;
}

bool chessboard_corners(const cv::Mat& grey, const Board& board, Points& corners) {
  const cv::Size size(board.corner_columns(), board.corner_rows());
  return cv::findChessboardCorners(grey, size, corners,
                                   cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE |
                                       cv::CALIB_CB_FAST_CHECK) ||
         cv::findChessboardCornersSB(grey, size, corners, cv::CALIB_CB_NORMALIZE_IMAGE);
}

Found find_chessboard(const cv::Mat& grey, const Board& board) {
  Points corners;
  if (!chessboard_corners(grey, board, corners))
    return {
        {},
        fmt::format("no chessboard of {}x{} squares, or not all of it", board.columns, board.rows)};
  Found found = in_rows(board, corners);
  const auto rough = found.corners;
  for (auto at = found.corners.begin(); at != found.corners.end();) {
    double nearest = 1e9;
    for (const auto& [id, other] : rough)
      if (id != at->first) nearest = std::min(nearest, cv::norm(other - rough.at(at->first)));
    const int reach = std::clamp(static_cast<int>(0.4 * nearest), 2, kFarthest);
    at = refine(grey, reach, at->second) ? std::next(at) : found.corners.erase(at);
  }
  return found;
}

bool dots_in(const cv::Mat& grey, const Board& board, Points& corners) {
  cv::SimpleBlobDetector::Params parameters;
  parameters.maxArea = static_cast<float>(grey.total()) / 20.0F;
  parameters.minDistBetweenBlobs = 5.0F;
  const auto detector = cv::SimpleBlobDetector::create(parameters);
  const int flags = board.kind == Board::Kind::circles ? cv::CALIB_CB_SYMMETRIC_GRID
                                                       : cv::CALIB_CB_ASYMMETRIC_GRID;
  const cv::Size size(board.columns, board.rows);
  return cv::findCirclesGrid(grey, size, corners, flags, detector) ||
         cv::findCirclesGrid(grey, size, corners, flags | cv::CALIB_CB_CLUSTERING, detector);
}

Found find_dots(const cv::Mat& grey, const Board& board) {
  Points corners;
  if (dots_in(grey, board, corners) || dots_in(255 - grey, board, corners)) {
    // An asymmetric grid is not its own mirror image: OpenCV tells its sides.
    if (board.kind == Board::Kind::circles) return in_rows(board, corners);
    Found found;
    for (int id = 0; id < board.corner_count(); ++id)
      found.corners[id] = corners[static_cast<size_t>(id)];
    return found;
  }
  return {{}, fmt::format("no {}, or not all of it", board.title())};
}

Found find(const cv::Mat& grey, const Board& board) {
  if (board.kind == Board::Kind::charuco) return find_charuco(grey, board);
  return board.dots() ? find_dots(grey, board) : find_chessboard(grey, board);
}

// ---- what is asked ----

/// Dictionaries that have the board's markers; of those that begin with the same ones the smallest.
std::vector<std::string> dictionaries_for(const Board& board) {
  std::vector<std::string> names;
  std::vector<cv::Mat> codes;
  for (const std::string& name : marker_dictionaries()) {
    const auto dictionary = dictionary_of(name);
    if (dictionary->bytesList.rows < board.marker_count()) continue;
    const cv::Mat own = dictionary->bytesList.rowRange(0, board.marker_count());
    const bool known = std::ranges::any_of(codes, [&](const cv::Mat& other) {
      return other.size() == own.size() && cv::norm(other, own, cv::NORM_INF) == 0.0;
    });
    if (known) continue;
    names.push_back(name), codes.push_back(own.clone());
  }
  return names;
}

struct Fit {
  std::string dictionary;
  size_t markers = 0, corners = 0;
};

std::vector<Fit> fits_of(const cv::Mat& grey, Board board) {
  std::vector<Fit> fits;
  for (const std::string& name : dictionaries_for(board)) {
    board.dictionary = name;
    const Found found = find_charuco(grey, board);
    fits.push_back({name, found.markers, found.corners.size()});
  }
  return fits;
}

/// The dictionary of which most markers are seen, and how many.
std::pair<std::string, size_t> most_seen(const cv::Mat& grey) {
  std::string best;
  size_t most = 3;  // a few are seen in any texture
  for (const std::string& name : marker_dictionaries()) {
    const size_t count = markers_in(grey, name).size();
    if (count > most) best = name, most = count;
  }
  return {best, most};
}

std::string markers_seen_in(const cv::Mat& grey) {
  const auto [best, most] = most_seen(grey);
  return best.empty() ? "" : fmt::format("{} markers of {} are", most, best);
}

std::string other_markers(const cv::Mat& grey, const std::string& told) {
  const auto [best, most] = most_seen(grey);
  if (best.empty() || best == told) return {};
  return fmt::format("{} markers of {} are in it: --dictionary {}", most, best, best);
}

std::string instead(const cv::Mat& grey, Board board) {
  const Board told = board;
  if (board.kind == Board::Kind::charuco) {
    std::swap(board.columns, board.rows);
    if (board.columns != told.columns && find_charuco(grey, board).corners.size() >= 6)
      return fmt::format("a {} is in it: --squares {}x{}", board.title(), board.columns,
                         board.rows);
    const std::vector<Fit> fits = fits_of(grey, told);
    const auto best = std::ranges::max_element(fits, {}, &Fit::markers);
    if (best != fits.end() && best->corners >= 6 && best->dictionary != told.dictionary)
      return fmt::format(
          "{} markers of {} are in it, in their places on this board: --dictionary {}",
          best->markers, best->dictionary, best->dictionary);
    return other_markers(grey, told.dictionary);
  }
  for (const auto& [more, what] : std::map<int, const char*>{
           {1, "squares are counted, not the corners between them"}, {-1, "one fewer"}}) {
    board.columns = told.columns + more, board.rows = told.rows + more;
    Points corners;
    if (board.dots() || board.corner_columns() < 3 || board.corner_rows() < 3) continue;
    if (chessboard_corners(grey, board, corners))
      return fmt::format("a {} is in it ({}): --squares {}x{}", board.title(), what, board.columns,
                         board.rows);
  }
  return {};
}

void start(Unpacker& request, const Board& board, Packer& out) {
  cv::Size size;
  request.get(size.width);
  request.get(size.height);
  std::vector<std::vector<cv::Point3f>> on_board(request.take<uint64_t>());
  std::vector<Points> in_photo(on_board.size());
  for (size_t i = 0; i < on_board.size(); ++i) {
    const auto ids = request.take<std::vector<int>>();
    const auto pixels = request.take<Eigen::Matrix2Xd>();
    for (size_t k = 0; k < ids.size(); ++k) {
      const Eigen::Vector3f x = board.corner(ids[k]).cast<float>();
      const Eigen::Vector2f p = pixels.col(static_cast<Eigen::Index>(k)).cast<float>();
      on_board[i].emplace_back(x.x(), x.y(), x.z());
      in_photo[i].emplace_back(p.x(), p.y());
    }
  }
  cv::Mat K, lens;
  std::vector<cv::Mat> rotations, shifts;
  int flags = cv::CALIB_FIX_K3 | cv::CALIB_ZERO_TANGENT_DIST;
  if (on_board.size() < 4) {  // too few to tell all of it
    K = cv::initCameraMatrix2D(on_board, in_photo, size);
    flags |=
        cv::CALIB_FIX_PRINCIPAL_POINT | cv::CALIB_FIX_ASPECT_RATIO | cv::CALIB_USE_INTRINSIC_GUESS;
  }
  cv::calibrateCamera(on_board, in_photo, size, K, lens, rotations, shifts, flags);
  Eigen::Matrix<double, 6, 1> numbers;
  numbers << K.at<double>(0, 0), K.at<double>(1, 1), K.at<double>(0, 2), K.at<double>(1, 2),
      lens.at<double>(0), lens.at<double>(1);
  Eigen::Matrix<double, 6, Eigen::Dynamic> poses(6, static_cast<Eigen::Index>(rotations.size()));
  for (size_t i = 0; i < rotations.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      poses(k, static_cast<Eigen::Index>(i)) = rotations[i].at<double>(k);
      poses(k + 3, static_cast<Eigen::Index>(i)) = shifts[i].at<double>(k);
    }
  out.put(numbers).put(poses);
}

/// Tags whose sides have clear edges.
void tags(const cv::Mat& grey, const std::string& dictionary, Packer& out) {
  const int cells = dictionary_of(dictionary)->markerSize + 2;
  std::vector<int> ids;
  std::vector<Points> squares;
  for (auto& [id, corners] : all_markers_in(grey, dictionary))
    if (refine_square(grey, cells, corners)) ids.push_back(id), squares.push_back(corners);
  Eigen::Matrix2Xd pixels(2, static_cast<Eigen::Index>(4 * ids.size()));
  for (size_t i = 0; i < ids.size(); ++i)
    for (size_t k = 0; k < 4; ++k)
      pixels.col(static_cast<Eigen::Index>(4 * i + k)) << squares[i][k].x, squares[i][k].y;
  out.put(ids).put(pixels);
}

std::string answer(Unpacker& request) {
  const auto task = request.take<std::string>();
  const Board board = unpack_board(request);
  Packer out;
  try {
    if (task == "start") {
      start(request, board, out);
      return out.take();
    }
    const int width = request.take<int>(), height = request.take<int>();
    auto bytes = request.take<std::string>();
    if (bytes.size() != static_cast<size_t>(width) * static_cast<size_t>(height)) throw WireFault();
    const cv::Mat grey(height, width, CV_8UC1, bytes.data());
    if (task == "tags") {
      tags(grey, board.dictionary, out);
      return out.take();
    }
    if (task == "dictionaries") {
      std::vector<std::string> names;
      std::vector<uint64_t> markers, corners;
      for (const Fit& one : fits_of(grey, board))
        names.push_back(one.dictionary), markers.push_back(one.markers),
            corners.push_back(one.corners);
      return out.put(names).put(markers).put(corners).take();
    }
    if (task == "markers") return out.put(markers_seen_in(grey)).take();
    if (task == "instead") return out.put(instead(grey, board)).take();
    const Found found = find(grey, board);
    std::vector<int> ids;
    Eigen::Matrix2Xd pixels(2, static_cast<Eigen::Index>(found.corners.size()));
    for (const auto& [id, corner] : found.corners) {
      pixels.col(static_cast<Eigen::Index>(ids.size())) << corner.x, corner.y;
      ids.push_back(id);
    }
    out.put(ids).put(pixels).put(found.why);
  } catch (const cv::Exception& error) {
    throw InputError({"OpenCV"}, error.err, "photos that show the board at several tilts");
  }
  return out.take();
}

}  // namespace
}  // namespace hookeye

int main() { return hookeye::serve(hookeye::answer); }
