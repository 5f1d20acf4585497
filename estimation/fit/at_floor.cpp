#include "estimation/fit/at_floor.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace hookeye {

namespace {

bool within(const Fitted& fitted, const Floor& floor, double times) {
  return fitted.evaluation.chi(false) <= times * floor.chi &&
         fitted.evaluation.chi(true) <= times * floor.chi;
}

struct Left {
  double r2 = 0.0, count = 0.0;
  double chi() const { return std::sqrt(r2 / count); }
};

/// What every camera with a floor of its own keeps of it, on fitted and on held-out photos.
std::vector<CameraOverFloor> cameras_over_floor(const Fitted& fitted, const Floor& floor) {
  std::vector<CameraOverFloor> out;
  if (floor.by_camera.empty()) return out;
  std::map<std::pair<std::string, bool>, Left> sums;
  for (const auto& example : fitted.evaluation.examples)
    for (const auto& photo : example.photos) {
      const auto& spec = fitted.form.scene->capture.examples[example.example].photos[photo.photo];
      Left& sum = sums[{spec.camera, example.held_out}];
      sum.r2 += photo.r2, sum.count += photo.count;
    }
  for (const auto& [of, left] : sums) {
    const auto own = floor.by_camera.find(of.first);
    if (own == floor.by_camera.end() || own->second <= 0.0 || left.count <= 0.0) continue;
    out.push_back({of.first, left.chi() / own->second, of.second});
  }
  return out;
}

/// What a camera has over its floor, over that floor [chi^2].
double excess(const CameraOverFloor& camera) {
  return std::max(0.0, camera.times * camera.times - 1.0);
}

/// One camera alone is wrong: of n, all that they have over their floors is its own, n times the
/// mean; a mesh or a law is wrong in all alike, once the mean. Whether it is over the floor, nearer
/// to the former, and by more than all that a renderer leaves at rest: its error goes from one
/// camera to the other as the body turns (Cycles, nothing hidden: 2.2 and 1.4 times the noise at
/// rest, 1.7 and 2.4 when twisted).
bool alone_over_floor(const CameraOverFloor& one, const std::vector<CameraOverFloor>& all,
                      const Floor& floor) {
  double sum = 0.0, count = 0.0;
  for (const CameraOverFloor& camera : all)
    if (camera.held_out == one.held_out) sum += excess(camera), count += 1.0;
  const double own = floor.by_camera.at(one.camera);
  return one.times > floor.limits->floor.at && excess(one) > 0.5 * (count + 1.0) * sum / count &&
         excess(one) * own * own > floor.chi * floor.chi - 1.0;
}

}  // namespace

bool at_floor(const Fitted& fitted, const Floor& floor) {
  return within(fitted, floor, floor.limits->floor.at);
}

bool on_floor(const Fitted& fitted, const Floor& floor) {
  return within(fitted, floor, floor.limits->floor.on);
}

CameraOverFloor most_over_floor(const Fitted& fitted, const Floor& floor) {
  const auto cameras = cameras_over_floor(fitted, floor);
  const auto rank = [&](const CameraOverFloor& one) {
    return std::pair(alone_over_floor(one, cameras, floor), one.times);
  };
  const auto most = std::max_element(cameras.begin(), cameras.end(), [&](auto& one, auto& other) {
    return rank(one) < rank(other);
  });
  return most == cameras.end() ? CameraOverFloor{} : *most;
}

bool explains_photos(const Fitted& fitted, const Floor& floor) {
  const auto cameras = cameras_over_floor(fitted, floor);
  return at_floor(fitted, floor) && std::none_of(cameras.begin(), cameras.end(), [&](auto& one) {
           return alone_over_floor(one, cameras, floor);
         });
}

double over_floor(const Fitted& fitted, const Floor& floor, bool held_out) {
  const double chi = fitted.evaluation.chi(held_out);
  return std::max(0.0, chi * chi - floor.chi * floor.chi);
}

bool spoils_held_out(const Fitted& fitted, const Floor& floor) {
  const double most = floor.limits->floor.at * floor.chi;
  return fitted.evaluation.chi(false) <= most && fitted.evaluation.chi(true) > most;
}

}  // namespace hookeye
