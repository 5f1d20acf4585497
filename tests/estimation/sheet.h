// A thin orthotropic sheet with a known answer, under corner pull and complex shear: what the
// additive model is tried on (Miguel, Miraut, Otaduy 2016, section 7).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "estimation/fit/fit.h"
#include "estimation/model/model.h"
#include "simulation/energy_model.h"

namespace hookeye::test {

struct SheetOptions {
  std::filesystem::path folder;             ///< the capture is written here
  std::shared_ptr<const EnergyTerm> truth;  ///< the law that makes the data
  /// Kinds of measurement: "positions", "forces", "photos".
  std::set<std::string> kinds = {"positions", "forces"};
  std::string fitted = "corner";  ///< motion that is fitted: "corner" or "shear"
  std::string material = "{law: stvk, lambda: 0.2, mu: 0.1}";
  std::string fit = "[lambda, mu]";
  double edge = 5.0;     ///< told mesh [mm]
  double finer = 0.7;    ///< edge of the truth's mesh over the told one
  int levels = 3;        ///< load levels of every motion
  double stretch = 1.0;  ///< size of all motions
  double position_sigma = 0.02, force_sigma = 0.005;  ///< [mm], [N]
  double force_share = 0.0;  ///< a force's noise is at least this share of it
  /// Fitted too: `pull`, the left edge held and this force on the right one [N]. It gives positions
  /// and photos alone their scale.
  std::optional<Eigen::Vector3d> dead_force;
  bool only_fitted = false;  ///< the other motion is not in the capture
  unsigned seed = 1;
};

/// 40 x 40 x 2 mm; axes 1 and 2 in its plane. corner_K: the left edge is held, the upper right
/// corner pulled along its diagonal and out of the plane. The complex shear, shear_K: the lower
/// edge is held, the upper one moved along itself, away and turned; and shear_side_K, the same with
/// the left and right edges, since one of them alone stretches the fibres of one axis only. Level K
/// of the fitted motion is fitted, its middle one held out; the other motion is held out, or left
/// out. Truth: another mesh, noise on everything.
std::shared_ptr<const Scene> make_sheet(const SheetOptions& options);

/// Orthotropic, stiffening, softer in compression than in tension in its plane: exponential fibres
/// along both axes (Holzapfel, Gasser, Ogden 2000) in a compressible neo-Hookean sheet.
/// stiff1, stiff2: fibre moduli; lock1, lock2: how fast they stiffen.
std::shared_ptr<const EnergyTerm> woven_sheet(double mu, double kappa, double stiff1, double lock1,
                                              double stiff2, double lock2);

/// Root mean square distance [mm] of the markers from the measured places, per motion; what was not
/// evaluated is not a number.
struct MarkerErrors {
  double corner = 0, shear = 0;
};
MarkerErrors marker_errors(const Scene& scene, const Fitted& fitted);

/// The fitted model on another scene of the same sheet, nothing moved.
Result<Fitted> shown_on(const std::shared_ptr<const Scene>& scene, const Fitted& fitted);

}  // namespace hookeye::test
