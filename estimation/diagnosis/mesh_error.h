// What the mesh's own error does to a fitted model, to first order: to its parameters, to what
// sensors show, and to what an effect may feed on (method.md: the mesh is a rival first).
#pragma once

#include "estimation/diagnosis/candidates.h"
#include "estimation/diagnosis/diagnosis_sums.h"

namespace hookeye {

/// The candidate with most evidence of those that make the mesh finer; null: none is offered.
const Candidate* mesh_candidate(const std::vector<Candidate>& candidates, const VectorXd& evidence);

/// mesh_shift, mesh_note and mesh_in_measured: what the fitted parameters do once the change `mesh`
/// is there in full, and what an ever finer mesh adds to it. Returned: the same as a step of all
/// columns of `evaluation`.
VectorXd tell_of_mesh(const Fitted& fitted, const Evaluation& evaluation, const DiagnosisSums& sums,
                      const Candidate& mesh, Diagnosis& out);

/// mesh_fall, mesh_shift, mesh_note and mesh_in_measured of a model whose mesh has been refined. It
/// has one parameter, a share of what the refinement changed; typical of it is what the next
/// refinement would change. The photos fit the share, and what they fit is no bound of the mesh's
/// error in a modulus, which falls at a rate of its own: the intervals reach for what the rule
/// leaves. Nor is it one of the error in the photos, whose next change has a shape of its own:
/// returned as a step of all columns of `evaluation`. Empty: not refined.
VectorXd tell_of_refined_mesh(const Fitted& fitted, const Evaluation& evaluation,
                              const DiagnosisSums& sums, Diagnosis& out);

/// Of what the next refinement would change (Diagnosis::mesh_fall), as much as the hypothesis could
/// imitate [chi^2]. The mesh moves the body; what changes brightness alone does not, and the fitted
/// share cannot have taken from it what it does not look like.
double imitated_by_mesh(const Fitted& fitted, const DiagnosisSums& sums,
                        const Hypothesis& hypothesis);

}  // namespace hookeye
