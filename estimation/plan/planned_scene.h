// A capture's scene with a load or views in it that nobody has photographed.
#pragma once

#include <map>

#include "estimation/plan/plan.h"

namespace hookeye {

/// Examples with photos that are fitted.
std::vector<int> fitted_examples(const Scene& scene);

/// The scene with one more example at its end, held out, so that nothing counts it as fitted. Its
/// photos are told but not taken.
std::shared_ptr<Scene> with_load(const Scene& now, const PlanCandidate& candidate);

/// (fitted example, photo) -> candidate
using ViewPhotos = std::map<std::pair<int, int>, int>;

/// The scene with all views among `candidates` as further photos of the fitted examples, told but
/// not taken.
std::shared_ptr<Scene> with_views(const Scene& now, const std::vector<PlanCandidate>& candidates,
                                  ViewPhotos& of_photo);

/// Takes the photos that are told but not there: the model's own pictures, with noise that goes
/// with intensity as in the photos of `now`. `states`: deformed positions by example.
void take_photos(Scene& scene, const Scene& now, const Model& model,
                 const std::map<int, VectorXd>& states);

}  // namespace hookeye
