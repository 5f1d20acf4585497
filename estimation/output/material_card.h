// The material that a fit found, as somebody would carry it elsewhere: its law, its values with
// intervals, what follows from them, and what they rest on.
#pragma once

#include <nlohmann/json.hpp>

#include "estimation/fit/mean_energy.h"

namespace hookeye {

/// `material` of metrics.json, and of diagnosis.json with intervals that reach for the mesh:
///   cards: one a material of the capture
///     region ("": the whole body), law
///     parameters: the law's own {name, unit, long_name, value, low, high, known}; `known`: fitted,
///       given (by the capture: no interval), open (the data do not hold it: no interval)
///     small_strain: the same of the moduli at rest that the parameters do not name, with all
///       effects on the energy: mu, kappa, E, nu = (3 kappa - 2 mu) / (2 (3 kappa + mu)); E along
///       x, y and z where they differ
///     curves: nominal stress of a bar over its stretch (uniaxial.h)
///   beside: effects that change the energy beside the law
///   depends: sentences on what fixes the scale of the moduli and what was not measured
///   yaml: the line of a capture, without the effects in `beside`
/// Null: no energy.
nlohmann::json material_card(const Scene& scene, const Fitted& fitted,
                             const EnergyNeighbourhood& near);

/// `material: {law: ...}` with the values of the model.
std::string material_yaml(const Capture& capture, const EnergyModel& energy);

}  // namespace hookeye
