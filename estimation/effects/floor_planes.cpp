#include "estimation/effects/floor_planes.h"

#include <fmt/format.h>

#include <cmath>

#include "estimation/effects/toolbox.h"

namespace hookeye {

const char* const kSides[6] = {"+x", "-x", "+y", "-y", "+z", "-z"};

Vector3d outward(int side) { return (side % 2 == 0 ? 1.0 : -1.0) * Vector3d::Unit(side / 2); }

std::string digits(const Vector3d& v) {
  return fmt::format("({:g}, {:g}, {:g})", v[0], v[1], v[2]);
}

ScoredPlane on_side(int side, double position) {
  return {outward(side), position,
          fmt::format("plane at {} side, position {}", kSides[side], position)};
}

ScoredPlane towards(const Vector3d& direction, double position) {
  return {direction.normalized(), position,
          fmt::format("plane towards {}, position {}", digits(direction), position)};
}

ScoredPlane plane_at(const Vector3d& direction, double position, double size) {
  // a hundredth of the smallest gap at most, wherever the frame has its origin
  const int decimals = std::max(0, 5 - static_cast<int>(std::floor(std::log10(size))));
  position = std::stod(fmt::format("{:.{}f}", position, decimals)) + 0.0;
  for (int side = 0; side < 6; ++side)
    if (direction == outward(side)) return on_side(side, position);
  return towards(direction, position);
}

std::optional<ScoredPlane> scored_plane(const std::string& variant) {
  const auto n = numbers_in(variant);
  for (int side = 0; side < 6; ++side)
    if (starts_with(variant, fmt::format("plane at {} side", kSides[side])) && n.size() == 1)
      return on_side(side, n[0]);
  if (!starts_with(variant, "plane towards") || n.size() != 4) return std::nullopt;
  const Vector3d direction(n[0], n[1], n[2]);
  return direction.norm() > 0.0 ? std::optional(towards(direction, n[3])) : std::nullopt;
}

std::string PlaneForm::variant() const {
  const char* kind = hard ? "hard plane" : "cushion";
  const std::string how = stiffness > 0.0 ? fmt::format(", stiffness {:g}", stiffness) : "";
  if (!tilts) return fmt::format("{} on side {}{}", kind, kSides[side], how);
  return fmt::format("{} towards {}, tilting about {}{}", kind, digits(out), digits(about), how);
}

Plane PlaneForm::plane(const VectorXd& values) const {
  const Vector3d along = out.normalized();
  const Vector3d there = about + (values[0] - along.dot(about)) * along;
  if (!tilts) return {along, there};
  const auto [a, b] = normal_axes(along);
  const auto tilt = values.tail<2>();
  return {rotation_of(tilt[0] * a + tilt[1] * b) * along, there};
}

std::optional<PlaneForm> plane_form(const std::string& variant) {
  const auto n = numbers_in(variant);
  for (const bool hard : {false, true}) {
    const auto stiffness = [&](size_t at) { return hard && n.size() == at + 1 ? n[at] : 0.0; };
    PlaneForm form{.hard = hard};
    form.stiffness = stiffness(0);
    for (form.side = 0; form.side < 6; ++form.side) {
      form.out = outward(form.side);
      if (variant == form.variant()) return form;
    }
    if (n.size() < 6) continue;
    form = {hard, true, -1, {n[0], n[1], n[2]}, {n[3], n[4], n[5]}, stiffness(6)};
    if (variant == form.variant() && form.out.norm() > 0.0) return form;
  }
  return std::nullopt;
}

}  // namespace hookeye
