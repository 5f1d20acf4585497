#include "estimation/output/uniaxial.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "estimation/fit/energy_curves.h"

namespace hookeye {
namespace {

using nlohmann::json;
using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

/// Entries of F that the sides are free in, stacked column by column: F is triangular with the axis
/// first, for a rotation costs nothing.
std::array<int, 5> free_entries(int axis) {
  const int a = axis, b = (axis + 1) % 3, c = (axis + 2) % 3;
  const auto at = [](int row, int column) { return row + 3 * column; };
  return {at(a, b), at(a, c), at(b, b), at(b, c), at(c, c)};
}

Vector5d gather(const Matrix3d& A, const std::array<int, 5>& entries) {
  Vector5d out;
  for (int i = 0; i < 5; ++i) out[i] = A.data()[entries[i]];
  return out;
}

/// Newton's step, damped until it goes downhill.
Vector5d downhill(const Matrix5d& H, const Vector5d& g) {
  const double size = H.diagonal().cwiseAbs().maxCoeff();
  for (double shift = 0.0; shift < 1e6 * size; shift = std::max(1e-3 * size, 10.0 * shift)) {
    const Eigen::LLT<Matrix5d> factor(H + shift * Matrix5d::Identity());
    if (factor.info() == Eigen::Success) return -factor.solve(g);
  }
  return -g / size;
}

}  // namespace

std::optional<UniaxialState> uniaxial(const MeanEnergy& energy, int axis, double stretch,
                                      const Matrix3d& start) {
  constexpr int kIterations = 60, kHalvings = 40;
  const auto entries = free_entries(axis);
  const double modulus = energy.dP_dF(Matrix3d::Identity()).diagonal().maxCoeff();
  Matrix3d F = start;
  F(axis, axis) = stretch;
  double psi = energy.psi(F);
  if (!std::isfinite(psi)) return {};
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Matrix3d P = energy.P(F);
    const Vector5d g = gather(P, entries);
    if (g.cwiseAbs().maxCoeff() <= 1e-10 * (modulus + P.cwiseAbs().maxCoeff()))
      return UniaxialState{F, P(axis, axis)};
    const Matrix9d D = energy.dP_dF(F);
    Matrix5d H;
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j) H(i, j) = D(entries[i], entries[j]);
    const Vector5d step = downhill(H, g);
    Matrix3d next = F;
    double length = 1.0, then = HUGE_VAL;
    // Near the end the energy no longer shows the fall, and the step is taken as it is.
    const double rounding = 1e-14 * (std::abs(psi) + modulus);
    for (int k = 0; k < kHalvings; ++k, length *= 0.5) {
      for (int i = 0; i < 5; ++i) next.data()[entries[i]] = F.data()[entries[i]] + length * step[i];
      then = energy.psi(next);
      if (then - psi <= 1e-4 * length * g.dot(step) + rounding) break;
    }
    if (!std::isfinite(then)) return {};
    F = next, psi = then;
  }
  return {};
}

namespace {

/// A curve from its middle outwards: each state starts from the one before it.
class Curve {
 public:
  Curve(const MeanEnergy& energy, const std::vector<BothSides<MeanEnergy>>& beside,
        const EnergyNeighbourhood& near, int axis)
      : energy_(energy), beside_(beside), near_(near), axis_(axis) {}

  struct Point {
    double stress = 0.0;
    EnergyNeighbourhood::Spread spread;
  };
  /// Empty from where the bar has no state.
  std::optional<Point> at(double stretch, std::optional<Matrix3d>& from) const {
    if (!from) return {};
    const auto state = uniaxial(energy_, axis_, stretch, *from);
    from = state ? std::optional(state->F) : std::nullopt;
    if (!state) return {};
    bool all = true;
    const VectorXd gradient = difference(beside_, near_.parameters(), [&](const MeanEnergy& one) {
      const auto other = uniaxial(one, axis_, stretch, state->F);
      all = all && other;
      return other ? other->stress : 0.0;
    });
    if (!all) return {};
    return Point{state->stress, near_.spread(gradient, state->stress)};
  }

 private:
  const MeanEnergy& energy_;
  const std::vector<BothSides<MeanEnergy>>& beside_;
  const EnergyNeighbourhood& near_;
  int axis_;
};

/// Stretches in order, rest among them: what was visited and half as far beyond.
std::vector<double> stretches(const Visited& seen) {
  const double margin = 0.5 * std::max(seen.high - seen.low, 0.02);
  const double low = std::max(seen.low - margin, 0.5 * seen.low), high = seen.high + margin;
  std::vector<double> out;
  const int below =
      std::clamp(static_cast<int>(std::lround((kCurvePoints - 1) * (1.0 - low) / (high - low))), 1,
                 kCurvePoints - 2);
  for (int i = 0; i < below; ++i) out.push_back(low + (1.0 - low) * i / below);
  for (int i = 0; i < kCurvePoints - below; ++i)
    out.push_back(1.0 + (high - 1.0) * i / (kCurvePoints - 1 - below));
  return out;
}

void push(json& one, double stretch, const std::optional<Curve::Point>& point) {
  one["stretch"].push_back(stretch);
  one["value"].push_back(point ? json(point->stress) : json());
  if (point && !point->spread.open)
    return push_band(one, point->stress, point->spread.half, point->spread.reach);
  one["low"].push_back(nullptr);
  one["high"].push_back(nullptr);
}

}  // namespace

json uniaxial_curves(const Scene& scene, const Fitted& fitted, const EnergyNeighbourhood& near,
                     int of) {
  json out = json::array();
  const EnergyModel& model = near.model().energy;
  if (model.parts.empty()) return out;
  const MeanEnergy energy(model, of);
  const auto beside = near.means(of);
  const Visited seen = visited_stretches(scene, near.model(), fitted, of).stretch;
  const bool framed = std::any_of(model.parts.begin(), model.parts.end(),
                                  [](const auto& part) { return part.frames.size() > 0; });
  const bool alike = pulls_alike(energy);
  const std::vector<double> all = stretches(seen);
  const auto rest = static_cast<size_t>(std::find(all.begin(), all.end(), 1.0) - all.begin());
  for (int axis = 0; axis < (alike ? 1 : 3); ++axis) {
    const Curve curve(energy, beside, near, axis);
    std::vector<std::optional<Curve::Point>> points(all.size());
    std::optional<Matrix3d> from = Matrix3d::Identity();
    for (size_t i = rest; i < all.size(); ++i) points[i] = curve.at(all[i], from);
    from = Matrix3d::Identity();
    for (size_t i = rest; i-- > 0;) points[i] = curve.at(all[i], from);
    const std::string along = framed ? std::to_string(axis + 1) : std::string(1, "xyz"[axis]);
    json one = {{"name", alike ? "pull" : (framed ? "pull along axis " : "pull along ") + along},
                {"axis", "stretch"},
                {"unit", scene.capture.units.stress()},
                {"visited", {seen.low, seen.high}}};
    for (size_t i = 0; i < all.size(); ++i) push(one, all[i], points[i]);
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace hookeye
