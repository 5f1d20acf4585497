// A capture's numbers in SI units.
#pragma once

#include <string>

#include "capture_io/capture.h"
#include "capture_io/newtons.h"
#include "meshing/tet_mesh.h"

namespace hookeye::inspection {

/// "104 mm", "3.5 m".
std::string length_in_words(double metres);
/// "51.2 g", "32 t".
std::string mass_in_words(double kilograms);
/// "the body is 80 m x 20 m x 20 m; of water it would have 32000 t": who has it in hand sees
/// whether the unit is right.
std::string size_in_words(const TetMesh& mesh, const Units& units);
/// "35 kPa", "0.035 Pa".
std::string stress_in_words(double pascals);

}  // namespace hookeye::inspection
