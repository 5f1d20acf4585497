// A bar of the fitted material under a pull: what a tensile test of it would show.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "estimation/fit/mean_energy.h"

namespace hookeye {

/// A bar pulled along one of the rest axes to a stretch, its sides free: all that may follow has
/// followed, so that the energy is at a minimum over it.
struct UniaxialState {
  Matrix3d F = Matrix3d::Identity();  ///< the line along the axis keeps its direction
  double stress = 0.0;                ///< force per rest area
};

/// From the sides of `start` (a state at a nearby stretch). Empty: Newton finds none, as where the
/// energy falls beyond every state.
std::optional<UniaxialState> uniaxial(const MeanEnergy& energy, int axis, double stretch,
                                      const Matrix3d& start = Matrix3d::Identity());

/// `curves` of a material's card (material_card.h): nominal stress over stretch with its 95 % band,
/// over what the fitted examples visit and half as far beyond: {name, axis, unit, stretch, value,
/// low, high, visited}; one where all three axes are alike, else one an axis. Material `of` of the
/// capture; -1: the mean of the body.
nlohmann::json uniaxial_curves(const Scene& scene, const Fitted& fitted,
                               const EnergyNeighbourhood& near, int of = -1);

}  // namespace hookeye
