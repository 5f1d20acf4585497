// Rows of a measured field's file that hold no measurement.
#pragma once

#include <vector>

#include "capture_io/capture.h"

namespace hookeye {

/// Lines of the file that were dropped, as FieldSpec::lines has those of the points: reads the
/// capture and the file again. Empty where the capture tells of no such field any more. Throws
/// InputError as read_field_table().
std::vector<int> dropped_lines(const Capture& capture, const MeasuredSpec& measured);

}  // namespace hookeye
