#include "calibration/start.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <tuple>

#include "calibration/turns.h"

namespace hookeye {
namespace {

/// camera_from_board.
struct Motion {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  Motion operator*(const Motion& b) const { return {R * b.R, R * b.t + t}; }
  Motion inverse() const { return {R.transpose(), -(R.transpose() * t)}; }
};

class Start {
 public:
  Start(const Board& board, const PhotoList& list) : turns_(board_turns(board)), list_(list) {
    bundle_.board = board;
  }

  void add_camera(const CameraPhotos& photos, size_t index, const std::vector<Detection>& found,
                  int lens) {
    Camera camera;
    camera.name = photos.name;
    std::tie(camera.width, camera.height) = list_.sizes[index];
    std::vector<const Detection*> seen;
    for (size_t i = 0; i < found.size(); ++i)
      if (list_.photos[i].camera == index && !found[i].ids.empty()) {
        seen.push_back(&found[i]);
        bundle_.views.push_back({index,
                                 list_.photos[i].instant,
                                 found[i].ids,
                                 found[i].pixels,
                                 std::vector<char>(found[i].ids.size(), 1),
                                 {}});
      }
    for (const ViewPose& pose : start_camera(camera, bundle_.board, seen))
      poses_.push_back({detail::turn(pose.rotation), pose.translation});
    camera.distortion.resize(static_cast<size_t>(lens));
    bundle_.cameras.push_back(camera);
  }

  /// From the first camera on, the one that shares most boards with those that are placed.
  void place_cameras() {
    std::vector<char> placed(bundle_.cameras.size(), 0);
    bundle_.boards.resize(list_.instants.size());
    board_known_.assign(list_.instants.size(), 0);
    place(0, Motion{}, placed);
    for (size_t n = 1; n < placed.size(); ++n) {
      size_t best = 0, most = 0;
      for (size_t c = 0; c < placed.size(); ++c)
        if (const size_t shared = placed[c] ? 0 : shared_views(c).size(); shared > most)
          best = c, most = shared;
      if (most == 0) refuse_unconnected(placed);
      place(best, pose_of_camera(best), placed);
    }
  }

  Bundle take() { return std::move(bundle_); }

 private:
  std::vector<size_t> views_of(size_t camera) const {
    std::vector<size_t> out;
    for (size_t v = 0; v < bundle_.views.size(); ++v)
      if (bundle_.views[v].camera == camera) out.push_back(v);
    return out;
  }
  std::vector<size_t> shared_views(size_t camera) const {
    std::vector<size_t> out = views_of(camera);
    std::erase_if(out, [&](size_t v) { return !board_known_[bundle_.views[v].board]; });
    return out;
  }

  Motion board_motion(size_t board) const {
    return {bundle_.boards[board].R, bundle_.boards[board].t};
  }

  /// As if the board had been taken for turned by `turn`.
  Motion turned(const Motion& pose, const BoardTurn& turn) const {
    return pose * Motion{turn.rotation, turn.shift}.inverse();
  }

  /// Root mean square of the view's corners with the camera at `camera_from_world` [px].
  double misfit(size_t v, const Motion& camera_from_world, const BoardTurn& turn) const {
    const BoardView& view = bundle_.views[v];
    const Motion board = board_motion(view.board);
    Camera camera = bundle_.cameras[view.camera];  // it may stand elsewhere, or nowhere yet
    camera.R = camera_from_world.R, camera.t = camera_from_world.t;
    double sum = 0.0;
    for (size_t i = 0; i < view.ids.size(); ++i) {
      const int id = turn.turned[static_cast<size_t>(view.ids[i])];
      const Eigen::Vector2d pixel = camera.project(board.R * bundle_.board.corner(id) + board.t);
      const double off = (pixel - view.pixels.col(static_cast<Eigen::Index>(i))).norm();
      sum += std::isfinite(off) ? std::min(off * off, 1e8) : 1e8;
    }
    return std::sqrt(sum / static_cast<double>(view.ids.size()));
  }

  const BoardTurn& best_turn(size_t v, const Motion& camera_from_world) const {
    return *std::ranges::min_element(
        turns_, {}, [&](const BoardTurn& turn) { return misfit(v, camera_from_world, turn); });
  }

  /// Each shared board proposes where the camera stands, in each of its turns; the proposal counts
  /// by which the shared boards come out best in the median.
  Motion pose_of_camera(size_t camera) const {
    const std::vector<size_t> shared = shared_views(camera);
    Motion best;
    double least = std::numeric_limits<double>::infinity();
    for (const size_t from : shared)
      for (const BoardTurn& turn : turns_) {
        const Motion proposal =
            turned(poses_[from], turn) * board_motion(bundle_.views[from].board).inverse();
        std::vector<double> off;
        for (const size_t v : shared) off.push_back(misfit(v, proposal, best_turn(v, proposal)));
        const auto middle = off.begin() + static_cast<long>(off.size() / 2);
        std::ranges::nth_element(off, middle);
        if (*middle < least) least = *middle, best = proposal;
      }
    return best;
  }

  void place(size_t index, const Motion& camera_from_world, std::vector<char>& placed) {
    Camera& camera = bundle_.cameras[index];
    camera.R = camera_from_world.R, camera.t = camera_from_world.t;
    placed[index] = 1;
    for (const size_t v : views_of(index)) {
      BoardView& view = bundle_.views[v];
      if (board_known_[view.board]) {
        const BoardTurn& turn = best_turn(v, camera_from_world);
        for (int& id : view.ids) id = turn.turned[static_cast<size_t>(id)];
        continue;
      }
      const Motion pose = camera_from_world.inverse() * poses_[v];
      bundle_.boards[view.board] = {pose.R, pose.t};
      board_known_[view.board] = 1;
    }
  }

  [[noreturn]] void refuse_unconnected(const std::vector<char>& placed) const {
    const size_t lost = static_cast<size_t>(std::ranges::find(placed, 0) - placed.begin());
    throw InputError({"camera " + bundle_.cameras[lost].name},
                     "no board was found in a photo of it and in one of another camera at the same "
                     "instant, so that nothing tells where it stands",
                     "some photos in which both cameras see the board at once; their names pair "
                     "them by the last number");
  }

  std::vector<BoardTurn> turns_;
  const PhotoList& list_;
  Bundle bundle_;
  std::vector<Motion> poses_;  ///< camera_from_board of each view
  std::vector<char> board_known_;
};

}  // namespace

Bundle start_bundle(const Board& board, const std::vector<CameraPhotos>& cameras,
                    const PhotoList& list, const std::vector<Detection>& found, int lens) {
  Start start(board, list);
  for (size_t c = 0; c < cameras.size(); ++c) start.add_camera(cameras[c], c, found, lens);
  start.place_cameras();
  return start.take();
}

}  // namespace hookeye
