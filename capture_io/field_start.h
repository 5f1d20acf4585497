// Where what a measured field holds starts: `from` of its entry.
#pragma once

#include <string>

#include "capture_io/capture.h"

namespace hookeye {

/// The example whose deformed body the program took as its reference: the field's places are those
/// of that state, and its displacements or strains lead on from there. "": the body as it was
/// given, or no field. (MeasuredSpec::region holds the name: a field has no region.)
const std::string& start_of(const MeasuredSpec& measured);

/// Throws InputError where a field starts from no example, its own, one that is held out for the
/// test alone, or where fields start from one another in a circle.
void check_field_starts(const Capture& capture);

}  // namespace hookeye
