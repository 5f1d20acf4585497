// A model with one effect more on the present mesh, and where to start it. Internal to refits and
// races.
#pragma once

#include <memory>
#include <utility>

#include "estimation/diagnosis/diagnosis.h"

namespace hookeye {

/// The effect that has its own mesh in this form. Null: the mesh stays.
const Effect* remeshed_by(const Ingredient& ingredient);

/// `model` on the mesh that `remeshing` asks for, with it, and where to start: at its null.
std::pair<ModelForm, VectorXd> on_its_mesh(const Model& model, const Ingredient& remeshing);

/// What the refinement of a mesh changed was worked out of the model that it was added to. `form`
/// has another effect or form now: it is worked out anew, of this one at `p`.
void work_out_anew(ModelForm& form, const VectorXd& p);

/// The refit form of a scored effect on the present mesh, and its values at `share` of the scored
/// step from the null. The refit form may have other parameters than the scored one (log stiffness
/// for compliance): it is told where the scored one would start.
std::pair<std::shared_ptr<const Ingredient>, VectorXd> entering(const Model& model,
                                                                const EffectScore& score,
                                                                double share);

/// The model with one effect more on the present mesh, and where to start it.
struct Extension {
  ModelForm form;
  VectorXd start;
  /// `share` of the scored step, the fitted parameters moving with it: a modulus that has made up
  /// for a wall would, with the wall, hold the body back twice.
  Extension(const Fitted& current, const EffectScore& score, double share);
};

/// A refit form without a way back to the null (a hard clamp) starts in the same place whatever the
/// share of the linear step.
bool starts_anywhere(const Fitted& current, const EffectScore& score);

/// The linear step is a direction more than a length: where it has no equilibrium or is worse than
/// the null, `run(extension)` starts nearer to the null.
template <class Run>
auto from_shares(const Fitted& current, const EffectScore& score, const FitOptions& options,
                 const Run& run) {
  auto result = run(Extension(current, score, 1.0));
  if (starts_anywhere(current, score)) return result;
  for (double share : {0.3, 0.1, 0.0}) {
    if (result || cancelled(result.error()) || (options.cancel && options.cancel->load())) break;
    result = run(Extension(current, score, share));
  }
  return result;
}

}  // namespace hookeye
