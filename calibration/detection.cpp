#include "calibration/detection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/ask_boards.h"

namespace hookeye {
namespace {

/// The brightest thousandth may be cut, so that a glint does not darken the rest.
std::string grey_of(const Image& photo, Grey how) {
  const double power = how == Grey::as_seen ? 1 / 2.2 : 1.0;
  const Image grey = luminance(photo);
  std::vector<float> sorted;
  for (size_t i = 0; i < grey.values.size(); i += 1 + grey.values.size() / 100000)
    if (std::isfinite(grey.values[i])) sorted.push_back(grey.values[i]);
  if (sorted.empty()) sorted.push_back(1.0F);
  const auto bright = sorted.begin() + static_cast<long>(0.999 * double(sorted.size() - 1));
  std::ranges::nth_element(sorted, bright);
  const float white = std::max(*bright, 1e-6F);
  std::string bytes(grey.values.size(), '\0');
  for (size_t i = 0; i < bytes.size(); ++i) {
    const float share = grey.values[i] / white;
    const double value = std::isfinite(share) ? std::clamp(share, 0.0F, 1.0F) : 0.0;
    bytes[i] = static_cast<char>(std::lround(255.0 * std::pow(value, power)));
  }
  return bytes;
}

bool on_a_line(const Board& board, const std::vector<int>& ids) {
  Eigen::Matrix2Xd x(2, static_cast<Eigen::Index>(ids.size()));
  for (size_t i = 0; i < ids.size(); ++i)
    x.col(static_cast<Eigen::Index>(i)) = board.corner(ids[i]).head<2>();
  x.colwise() -= x.rowwise().mean().eval();
  const Eigen::Matrix2d spread = x * x.transpose() / static_cast<double>(ids.size());
  return spread.determinant() < 1e-3 * board.pitch * board.pitch * spread.trace();
}

}  // namespace

Packer boards_request(const char* task, const Image& photo, const Board& board, Grey grey) {
  Packer what;
  what.put(task);
  pack(what, board);
  what.put(photo.width).put(photo.height).put(grey_of(photo, grey));
  return what;
}

HelperRequest to_boards(Packer& what, const std::string& file) {
  HelperRequest request;
  request.name = "boards";
  request.content = what.take();
  request.limits = {4.0 * (1 << 30), 120.0};
  request.place = {file};
  request.right = "another photo of the board, or a smaller one";
  request.damaged = "OpenCV gave up on the photo";
  return request;
}

bool boards_can_be_found() { return std::filesystem::exists(helper_folder() / "boards"); }

Detection detect(const Image& photo, const Board& board, const std::string& file) {
  Packer what = boards_request("detect", photo, board);
  Detection found = ask_boards(what, file, [&](Unpacker& from) {
    Detection got;
    from.get(got.ids);
    from.get(got.pixels);
    from.get(got.why);
    const bool fits = static_cast<size_t>(got.pixels.cols()) == got.ids.size();
    if (!fits ||
        std::ranges::any_of(got.ids, [&](int id) { return id < 0 || id >= board.corner_count(); }))
      throw WireFault();
    return got;
  });
  const bool few = found.ids.size() < kFewestCorners;
  if (!few && !on_a_line(board, found.ids)) return found;
  if (found.why.empty())
    found.why =
        few ? fmt::format("only {} corners, {} are needed", found.ids.size(), kFewestCorners)
            : "its corners lie on one line";
  found.ids.clear();
  found.pixels.resize(2, 0);
  return found;
}

std::string seen_instead(const Image& photo, const Board& board, const std::string& file) {
  Packer what = boards_request("instead", photo, board);
  return ask_boards(what, file, [](Unpacker& from) { return from.take<std::string>(); });
}

std::vector<DictionaryFit> try_dictionaries(const Image& photo, const Board& board,
                                            const std::string& file) {
  Packer what = boards_request("dictionaries", photo, board);
  return ask_boards(what, file, [](Unpacker& from) {
    const auto names = from.take<std::vector<std::string>>();
    const auto markers = from.take<std::vector<uint64_t>>();
    const auto corners = from.take<std::vector<uint64_t>>();
    if (markers.size() != names.size() || corners.size() != names.size()) throw WireFault();
    std::vector<DictionaryFit> fits;
    for (size_t i = 0; i < names.size(); ++i) fits.push_back({names[i], markers[i], corners[i]});
    return fits;
  });
}

std::string markers_seen(const Image& photo, const Board& board, const std::string& file) {
  Packer what = boards_request("markers", photo, board);
  return ask_boards(what, file, [](Unpacker& from) { return from.take<std::string>(); });
}

std::vector<ViewPose> start_camera(Camera& camera, const Board& board,
                                   const std::vector<const Detection*>& photos) {
  Packer what;
  what.put("start");
  pack(what, board);
  what.put(camera.width).put(camera.height).put<uint64_t>(photos.size());
  for (const Detection* photo : photos) what.put(photo->ids).put(photo->pixels);
  std::vector<ViewPose> poses(photos.size());
  ask_boards(what, "camera " + camera.name, [&](Unpacker& from) {
    const auto numbers = from.take<Eigen::Matrix<double, 6, 1>>();
    const auto found = from.take<Eigen::Matrix<double, 6, Eigen::Dynamic>>();
    if (!numbers.allFinite() || !found.allFinite() ||
        static_cast<size_t>(found.cols()) != photos.size())
      throw WireFault();
    camera.fx = numbers[0], camera.fy = numbers[1], camera.cx = numbers[2], camera.cy = numbers[3];
    camera.distortion = {numbers[4], numbers[5], 0.0, 0.0, 0.0};
    for (Eigen::Index i = 0; i < found.cols(); ++i)
      poses[static_cast<size_t>(i)] = {found.col(i).head<3>(), found.col(i).tail<3>()};
    return true;
  });
  return poses;
}

}  // namespace hookeye
