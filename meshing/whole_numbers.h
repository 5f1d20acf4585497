// Libraries read the numbers of nodes into 32 bits and drop what does not fit: 2^32 + 5 counts
// as 5.
#pragma once

#include <string_view>

#include "core/input_error.h"

namespace hookeye::detail {

/// Throws InputError where a whole number in the line is beyond 32 bits. Fields are separated by
/// blanks and slashes; what is no whole number is passed over.
void check_whole_numbers(std::string_view line, const Place& place);

}  // namespace hookeye::detail
