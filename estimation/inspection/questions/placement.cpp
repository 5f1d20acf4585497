// Does the body lie where `placement` says, by its outline in the photos at rest?
#include "estimation/inspection/outline_gap.h"
#include "estimation/inspection/question.h"

namespace hookeye::inspection {

/// Asked where a place is told, also where a fit refines it: a fit starts there, and no fit of
/// pictures comes back from so far. Without `placement` a weight that is not told may bend a body
/// at rest as far, and nobody has claimed its place.
void ask_placement(Sight& sight, Warnings& warnings) {
  if (!warnings.has({"body", "placement"})) return;
  if (auto doubt = outline_doubt(sight))
    warnings.say(warnings.place({"body", "placement"}), doubt->seen, doubt->right);
}

}  // namespace hookeye::inspection
