// When the mesh is settled before anything is named: on a mesh that is known to be wrong, whatever
// resembles its error would be. Internal to discover.
#pragma once

#include <string>

#include "estimation/search/discover.h"

namespace hookeye {

/// A numerical error that would remove at least half of the misfit. The finer mesh was solved for
/// the score: where it leaves more than that, something larger is missing, and the mesh is asked
/// after it.
bool may_be_all(const std::string& effect, const Diagnosis& diagnosis);

/// The mesh, where nobody is ahead of it by more than a tie and takes away more of the misfit, too:
/// its one number is the change that was solved, six of a set-up may lead by fitting its noise.
/// Else null.
const EffectScore* mesh_ahead(const Diagnosis& diagnosis);

/// The mesh leads by more than a tie, and the step that it promises brings fitted and held-out
/// photos to the floor. That step is no guess (the finer mesh was solved), the mesh is settled
/// before anything is named, and what it leaves is diagnosed next: nobody needs to race.
bool mesh_settles_it(const Step& step);

/// Nobody was ahead of the mesh, it asked for what a mesh's error asks for (once
/// the change that was solved where the truth is as fine, twice, 1/(1 - 0.7^2), where it is exact;
/// half to double of that), and its refit took away at least half of the misfit that it promised
/// to. On the mesh that is known to be wrong, whatever resembles its error would be named beside a
/// small effect; what stands out on the finer one is diagnosed next.
bool mesh_kept_its_word(const Step& step, const Fitted& refitted);

}  // namespace hookeye
