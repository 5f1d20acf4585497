#include "app/commands/check_covariance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "capture_io/camera_covariance.h"
#include "runs/text.h"

namespace hookeye {
namespace {

using Json = nlohmann::ordered_json;

/// Root of the sum of variances of the camera's numbers whose names begin so; 0: none has one.
double deviation_of(const CameraCovariance& of, const std::string& camera,
                    const std::string& start) {
  double sum = 0.0;
  for (size_t i = 0; i < of.numbers.size(); ++i)
    if (of.numbers[i].camera == camera && of.numbers[i].name.starts_with(start))
      sum += of.deviation(i) * of.deviation(i);
  return std::sqrt(sum);
}

}  // namespace

Json describe_covariance(const Capture& capture) {
  if (!capture.camera_covariance) return nullptr;
  const CameraCovariance& known = *capture.camera_covariance;
  Json cameras = Json::array(), as_told = Json::array();
  const auto names = known.cameras();
  for (const std::string& name : names) {
    const auto numbers = std::ranges::count(known.numbers, name, &CameraCovariance::Number::camera);
    cameras.push_back({{"name", name},
                       {"numbers", numbers},
                       {"rotation_rad", deviation_of(known, name, "rotation_")},
                       {"shift", deviation_of(known, name, "shift_")},
                       {"fx", deviation_of(known, name, "fx") / capture.camera(name).fx}});
  }
  for (const Camera& camera : capture.cameras)
    if (std::ranges::find(names, camera.name) == names.end()) as_told.push_back(camera.name);
  return {{"file", known.told},
          {"cameras", std::move(cameras)},
          {"as_told", std::move(as_told)},
          {"not_in_capture", known.strangers}};
}

void say_covariance(const Json& described, const Units& units, const Session& session) {
  if (described.is_null()) return;
  std::string out = fmt::format("known as {} has them:", described["file"].get<std::string>());
  const char* between = " ";
  for (const Json& camera : described["cameras"]) {
    out += fmt::format(
        "{}{} to {:.2g} degrees, {:.2g} {}, {:.2g} % of fx", between,
        camera["name"].get<std::string>(), camera["rotation_rad"].get<double>() * 180.0 / M_PI,
        camera["shift"].get<double>(), units.length, 100.0 * camera["fx"].get<double>());
    between = "; ";
  }
  const auto names = described["as_told"].get<std::vector<std::string>>();
  if (!names.empty()) out += fmt::format("; {} exactly", fmt::join(names, ", "));
  session.say("{}", wrapped(out, 2));
}

}  // namespace hookeye
