// Whether photos still show the body move beside the model, however little of chi that takes: a
// mean over a million pixels hides an arrow of some pixels.
#pragma once

#include <string>
#include <vector>

#include "estimation/evaluation/evaluation.h"
#include "estimation/fit/floor.h"

namespace hookeye {

/// Smooth motion (smooth_motion.h) that a photo keeps. Of its channels the one that keeps most.
struct MotionLeft {
  int example = 0, photo = 0;  ///< of a field: its place among what is measured
  bool held_out = false;
  double px = 0.0;       ///< root mean square over the photo; of a silhouette, across its rim
  double most_px = 0.0;  ///< what chance, the renderer and the mesh may leave
  bool field = false;    ///< then px and most_px are lengths (or strains), over the field
  double times() const { return px / most_px; }
};

/// Of every photo with enough cells, and of every field, in their order. Needs an evaluation with
/// pictures. All photos of a right model together keep less than `most_px` but in
/// FloorLimits::chance of cases (Bonferroni). Noise is what the photo itself keeps beside its
/// smooth part, correlated as that is. What the computation may err by adds to it as vectors do at
/// most (triangle inequality): FloorLimits::moved_px or rim_px all over, and what an ever finer
/// mesh would change, `mesh_step` of all columns (mesh_error.h; empty: not known). A field is held
/// to chance and the mesh alone.
std::vector<MotionLeft> motions_left(const Scene& scene, const Evaluation& evaluation,
                                     const Floor& floor, const VectorXd& mesh_step);

/// Who keeps most over what it may keep; null: nobody does.
const MotionLeft* most_moved(const std::vector<MotionLeft>& motions);

/// "the photo of camera 'left' in 'pull' still shows the body moved smoothly, by 0.8 px where
/// noise, renderer and mesh leave 0.1 at most".
std::string in_words(const MotionLeft& motion, const Scene& scene);

}  // namespace hookeye
