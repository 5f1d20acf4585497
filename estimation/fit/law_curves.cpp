// What the data say of a material: its energy under a pull and under pressure,
// with the band that the parameters' covariance gives, over the strains that the examples visit.
#include <cmath>

#include "estimation/fit/energy_curves.h"

namespace hookeye {
namespace {

using nlohmann::json;

/// One family of strains: F over its coordinate, 1 at rest.
struct Family {
  std::string name, axis;
  int direction;  ///< of the pull; -1: the same all round
  Matrix3d F(double x) const {
    if (direction < 0) return std::cbrt(x) * Matrix3d::Identity();
    Eigen::Vector3d stretch = Eigen::Vector3d::Constant(1.0 / std::sqrt(x));
    stretch[direction] = x;
    return stretch.asDiagonal();
  }
};

std::vector<Family> families(const MeanEnergy& energy) {
  std::vector<Family> out;
  if (pulls_alike(energy))
    out.push_back({"pull", "stretch at constant volume", 0});
  else
    for (int i = 0; i < 3; ++i)
      out.push_back({std::string("pull along ") + "xyz"[i], "stretch at constant volume", i});
  out.push_back({"volume", "volume ratio J", -1});
  return out;
}

}  // namespace

bool pulls_alike(const MeanEnergy& energy) {
  // Compared at a stretch that no example needs to reach.
  const double x = energy.psi(Family{"", "", 0}.F(1.3)), y = energy.psi(Family{"", "", 1}.F(1.3)),
               z = energy.psi(Family{"", "", 2}.F(1.3));
  return std::max(std::abs(y - x), std::abs(z - x)) <= 1e-9 * std::abs(x);
}

json law_curves(const Scene& scene, const Fitted& fitted, const EnergyNeighbourhood& near) {
  json out = json::array();
  if (near.model().energy.parts.empty()) return out;
  const MeanEnergy energy(near.model().energy);
  const auto beside = near.means();
  const VisitedStretches visited = visited_stretches(scene, near.model(), fitted);
  for (const Family& family : families(energy)) {
    const Visited& seen = family.direction < 0 ? visited.volume : visited.isochoric;
    const double margin = 0.1 * std::max(seen.high - seen.low, 0.02);
    json one = {{"name", family.name},
                {"axis", family.axis},
                {"unit", scene.capture.units.stress()},
                {"visited", {seen.low, seen.high}}};
    for (int i = 0; i < kCurvePoints; ++i) {
      const double x =
          seen.low - margin + (seen.high - seen.low + 2.0 * margin) * i / (kCurvePoints - 1);
      const Matrix3d F = family.F(x);
      const double value = energy.psi(F);
      const auto spread = near.spread(
          difference(beside, near.parameters(), [&](const MeanEnergy& one) { return one.psi(F); }),
          value);
      one["stretch"].push_back(x);
      one["value"].push_back(value);
      push_band(one, value, spread.half, spread.reach);
    }
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace hookeye
