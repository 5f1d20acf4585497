#include "estimation/diagnosis/seen.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace hookeye {

double change(const Eigen::MatrixXd& H, const VectorXd& s, const VectorXd& step) {
  return 2.0 * step.dot(s) + step.dot(H * step);
}

namespace {

std::string where_seen_in_fields(const Scene& scene, const Evaluation& evaluation,
                                 const VectorXd& step) {
  std::string out;
  double most = 0.0;
  for (const auto& example : evaluation.examples)
    for (const auto& field : example.measured) {
      if (example.held_out || !field.is_field()) continue;
      const double fall = field.r.squaredNorm() - (field.r + field.J * step).squaredNorm();
      if (fall <= most) continue;
      most = fall;
      out = fmt::format("; seen most in the field of '{}'",
                        scene.capture.examples[example.example].name);
    }
  return out;
}

}  // namespace

std::string where_seen(const Scene& scene, const Evaluation& evaluation, const VectorXd& step) {
  std::map<std::string, double> by_camera, by_example;
  double total = 0.0;
  for (const auto& example : evaluation.examples)
    for (const auto& photo : example.photos) {
      if (example.held_out) continue;
      const double fall = -change(photo.sums.JtJ, photo.sums.Jtr, step);
      const auto& spec = scene.capture.examples[example.example];
      by_camera[spec.photos[photo.photo].camera] += fall;
      by_example[spec.name] += fall;
      total += fall;
    }
  if (by_camera.empty()) return where_seen_in_fields(scene, evaluation, step);
  if (total <= 0.0) return "";
  std::vector<std::string> cameras;
  for (const auto& [name, fall] : by_camera)
    if (fall > 0.05 * total) cameras.push_back("'" + name + "'");
  const auto most = std::max_element(by_example.begin(), by_example.end(),
                                     [](auto& a, auto& b) { return a.second < b.second; });
  std::string who = fmt::format("{}", fmt::join(cameras, " and "));
  if (cameras.size() == by_camera.size() && cameras.size() > 1)
    who = cameras.size() == 2 ? "both cameras" : fmt::format("all {} cameras", cameras.size());
  return fmt::format("; seen in {}, most in '{}'", who, most->first);
}

std::string seen_by_sensors(double before, double after, double count) {
  const auto off = [&](double r2) { return std::sqrt(r2 / std::max(count, 1.0)); };
  return fmt::format(
      "; what was measured would be off by {:.1f} instead of {:.1f} times their told noise",
      off(after), off(before));
}

}  // namespace hookeye
