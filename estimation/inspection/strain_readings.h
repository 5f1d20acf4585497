// Other ways to read a field of strains: another measure or unit, axes in each other's places, a
// shear of the other sign or twice as large.
#pragma once

#include <string>
#include <vector>

#include "estimation/inspection/sight.h"

namespace hookeye::inspection {

/// Strains that ought to be measured, by component and point, and what reading they are of.
struct StrainReading {
  VectorXd expected;  ///< as MeasuredSpec::value
  std::string is;     ///< "the measure is hencky"
  std::string right;  ///< what to write
};

/// The strains of all measures out of the displacements beside them in the file, by `told`'s
/// measure first; over discs of the told gauge, or of the next points. Those that cannot be told
/// are not finite. Empty: there are no displacements.
std::vector<StrainReading> out_of_displacements(const TetMesh& mesh, const FieldSpec& told,
                                                const InspectionOptions& options);

/// What else the shear and the axes may be, for one right answer: as told first.
std::vector<StrainReading> other_readings(const FieldSpec& told, const StrainReading& right);

}  // namespace hookeye::inspection
