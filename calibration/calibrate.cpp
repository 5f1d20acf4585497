#include "calibration/calibrate.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calibration/board_options.h"
#include "calibration/detection.h"
#include "calibration/dictionary.h"
#include "calibration/start.h"
#include "core/interrupted.h"

namespace hookeye {
namespace {

std::vector<Detection> find_boards(const Board& board, const PhotoList& list,
                                   const CalibrateOptions& options) {
  std::vector<Detection> found;
  for (const BoardPhoto& photo : list.photos) {
    if (options.stopped()) throw Interrupted{};
    found.push_back(detect(read_image(photo.file), board, photo.file.string()));
    if (options.progress) options.progress(found.size(), list.photos.size());
  }
  return found;
}

/// What photos without the board show instead; "": nothing that is known.
std::string seen_instead_in(const std::vector<size_t>& without, const Board& board,
                            const PhotoList& list) {
  constexpr size_t kMostLooks = 3;
  for (size_t i = 0; i < std::min(kMostLooks, without.size()); ++i) {
    const BoardPhoto& photo = list.photos[without[i * (without.size() - 1) / kMostLooks]];
    const std::string other = seen_instead(read_image(photo.file), board, photo.file.string());
    if (!other.empty()) return other;
  }
  return {};
}

/// What is most often wrong where no photo shows the board, with what a few of them show instead.
[[noreturn]] void refuse_unseen(const Board& board, const PhotoList& list,
                                const std::vector<Detection>& found) {
  std::vector<size_t> all(found.size());
  std::iota(all.begin(), all.end(), size_t{0});
  std::string right = seen_instead_in(all, board, list);
  if (right.empty())
    right =
        "told as it is printed (squares are counted, not corners), flat, sharp, whole, with a "
        "white rim";
  throw InputError({list.photos.front().file.string()},
                   fmt::format("no {} was found in any of {} photos; in this one: {}",
                               board.title(), found.size(), found.front().why),
                   right);
}

void refuse_without_boards(const Board& board, const std::vector<CameraPhotos>& cameras,
                           const PhotoList& list, const std::vector<Detection>& found) {
  std::vector<size_t> count(cameras.size(), 0);
  for (size_t i = 0; i < found.size(); ++i) count[list.photos[i].camera] += !found[i].ids.empty();
  if (std::ranges::all_of(count, [](size_t n) { return n == 0; }))
    refuse_unseen(board, list, found);
  constexpr size_t kFewest = 3;
  for (size_t c = 0; c < cameras.size(); ++c) {
    if (count[c] >= kFewest) continue;
    // A board of fewer squares may be found in a part of a larger one.
    std::vector<size_t> without;
    for (size_t i = 0; i < found.size(); ++i)
      if (list.photos[i].camera == c && found[i].ids.empty()) without.push_back(i);
    const std::string other = seen_instead_in(without, board, list);
    throw InputError(
        {"camera " + cameras[c].name},
        fmt::format("the board was found in {} of its photos, {} are the least", count[c], kFewest),
        !other.empty() ? other
                       : "ten photos or more that show the board, tilted and all over "
                         "the picture; squares are counted, not corners");
  }
}

/// The instant of the photo that `--frame` names.
size_t instant_of(const PhotoList& list, const std::vector<Detection>& found,
                  const std::string& frame) {
  for (size_t i = 0; i < list.photos.size(); ++i) {
    const std::filesystem::path& file = list.photos[i].file;
    if (file != frame && file.filename() != frame) continue;
    if (found[i].ids.empty())
      throw InputError({file.string()},
                       "no board was found in the photo of --frame: " + found[i].why,
                       "a photo in which the board was found");
    return list.photos[i].instant;
  }
  throw InputError({frame}, "--frame names none of the photos",
                   "the name of a photo that is calibrated from");
}

/// The world turned so that the frame of `board` is it.
void move_world(Bundle& bundle, size_t board) {
  const BoardPose frame = bundle.boards[board];
  for (Camera& camera : bundle.cameras) {
    camera.t += camera.R * frame.t;
    camera.R = camera.R * frame.R;
  }
  for (BoardPose& pose : bundle.boards) {
    pose.t = frame.R.transpose() * (pose.t - frame.t);
    pose.R = frame.R.transpose() * pose.R;
  }
  bundle.boards[board] = {};
  bundle.world_board = board;
}

void tell_photos(Calibration& result, const std::vector<Detection>& found) {
  std::vector<double> squares(result.bundle.cameras.size(), 0.0), count = squares;
  size_t next = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    PhotoResult photo{result.list.photos[i], found[i].ids.size(), 0, 0.0, found[i].why, {}};
    if (!found[i].ids.empty()) {
      const BoardView& view = result.bundle.views[next];
      photo.view = next++;
      double sum = 0.0;
      for (size_t k = 0; k < view.ids.size(); ++k) {
        if (!view.used[k]) continue;
        sum += view.residuals.col(static_cast<Eigen::Index>(k)).squaredNorm();
        ++photo.used;
      }
      photo.rms_px = photo.used ? std::sqrt(sum / static_cast<double>(photo.used)) : 0.0;
      if (photo.used == 0) photo.why = "left out: nearly all its corners are off";
      squares[view.camera] += sum, count[view.camera] += static_cast<double>(photo.used);
      result.corners += view.ids.size();
      result.dropped += view.ids.size() - photo.used;
    }
    result.photos.push_back(std::move(photo));
  }
  for (size_t c = 0; c < squares.size(); ++c)
    result.rms_px.push_back(std::sqrt(squares[c] / std::max(count[c], 1.0)));
}

InputError undetermined(const std::string& what) {
  return {
      {"photos"},
      what,
      "more photos, the board tilted by 20 to 40 degrees to all sides, near and far, out to the "
      "corners of the picture; or a smaller --lens"};
}

}  // namespace

Calibration calibrate(const Board& told, const std::vector<CameraPhotos>& cameras,
                      const CalibrateOptions& options) {
  if (std::ranges::count(lens_numbers(), options.lens) == 0)
    throw bad_calibration(
        fmt::format("--lens {} is no count of numbers that a lens has", options.lens),
        fmt::format("one of {}", fmt::join(lens_numbers(), ", ")));
  Calibration result;
  result.list = list_photos(cameras);
  Board board = told;
  if (board.kind == Board::Kind::charuco && board.dictionary.empty())
    result.list.said.push_back(find_dictionary(board, result.list, options));
  const std::vector<Detection> found = find_boards(board, result.list, options);
  refuse_without_boards(board, cameras, result.list, found);
  result.world = "the axes of " + cameras.front().name;
  std::optional<size_t> frame;
  if (!options.frame.empty()) frame = instant_of(result.list, found, options.frame);
  Bundle& bundle = result.bundle;
  bundle = start_bundle(board, cameras, result.list, found, options.lens);
  if (frame) {
    move_world(bundle, *frame);
    result.world = "the board in " + std::filesystem::path(options.frame).filename().string() +
                   ": x along its rows, y down its columns, z into it";
  }
  if (options.stopped()) throw Interrupted{};
  if (!settle(bundle)) throw undetermined("the least squares over all corners fail");
  for (size_t c = 0; c < cameras.size(); ++c)
    if (std::ranges::none_of(bundle.views, [&](const BoardView& v) {
          return v.camera == c && std::ranges::count(v.used, 1) > 0;
        }))
      throw undetermined(fmt::format("no photo of `{}` agrees with the others", cameras[c].name));
  if (frame && std::ranges::none_of(bundle.views, [&](const BoardView& v) {
        return v.board == *frame && std::ranges::count(v.used, 1) > 0;
      }))
    throw InputError({options.frame}, "the board in the photo of --frame does not fit the others",
                     "another photo behind --frame, in which the board lies still and flat");
  const auto errors = covariance(bundle);
  if (!errors)
    throw undetermined("the photos leave some number of the cameras open: no covariance is found");
  result.errors = *errors;
  tell_photos(result, found);
  result.said = result.list.said;
  result.warnings = doubts(result);
  return result;
}

}  // namespace hookeye
