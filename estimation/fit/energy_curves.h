// What the data say of a material: its energy with a 95 % band, the strains that the examples
// visit, and where an additive model is asked beyond its control points.
#pragma once

#include <nlohmann/json.hpp>

#include "estimation/fit/mean_energy.h"
#include "estimation/model/additive_material.h"

namespace hookeye {

constexpr int kCurvePoints = 41;

/// The value below which `share` of `values` lie; at least one value. Reorders them.
double quantile(std::vector<double>& values, double share);

/// Appends to `low` and `high` of a curve: `half` of noise on both sides, and on the side where an
/// ever finer mesh would take the value what it would change, `reach` (Fitted::mesh_reach to first
/// order).
void push_band(nlohmann::json& curve, double value, double half, double reach);

/// Strains of the components over all points where the energy is evaluated and the part of the
/// energy acts, in its frames, fitted examples only: the range between the 1 % and 99 % quantiles
/// of the volume, and always 0.
struct VisitedStrains {
  std::vector<double> low, high;  ///< by component
};
VisitedStrains visited_strains(const ModelForm& form, const Fitted& fitted,
                               const AdditiveModel& model, int part = 0);

/// Per element, of how many addends of the part's material it is beyond the control points.
VectorXd addends_beyond(const Scene& scene, const AdditiveModel& model, const Model& realised,
                        const VectorXd& q, int part = 0);
/// The same over all materials; empty where none is additive.
VectorXd addends_beyond(const Scene& scene, const Model& realised, const VectorXd& q);

/// The first of `metrics.energy`, of any material, effects included: a pull at constant volume
/// (along x, y and z where that differs) and a change of volume, of the mean over the body. Bands
/// to first order in the parameters.
nlohmann::json law_curves(const Scene& scene, const Fitted& fitted,
                          const EnergyNeighbourhood& near);
/// Whether a pull along x, y and z costs the same.
bool pulls_alike(const MeanEnergy& energy);
/// The rest of `metrics.energy`, of additive materials: one curve an addend {name, unit, axis,
/// stretch, value, low, high, visited, beyond}: Psi over its component (`stretch` holds the
/// strains, `axis` names them), a two-component addend along its first component with the second at
/// its largest visited size.
nlohmann::json energy_curves(const Scene& scene, const Fitted& fitted);
/// `metrics.additive`: smallest eigenvalue now and over all accepted steps that led here (null
/// where only named values were fitted), refinements. Null where no material is additive.
nlohmann::json additive_metrics(const Fitted& fitted);

}  // namespace hookeye
