// Lines of fields, as people write pairs and tags.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/input_error.h"

namespace hookeye {

struct FieldLine {
  Place place;
  std::vector<std::string> fields;  ///< one at least
};

/// Fields are separated by blanks, tabs, commas or semicolons; `#` begins a comment. Lines without
/// a field are left out. Throws InputError.
std::vector<FieldLine> field_lines(const std::filesystem::path& file);

/// The fields from `first` on as `count` finite numbers; empty: others stand there.
std::vector<double> numbers_in(const std::vector<std::string>& fields, size_t first, size_t count);

}  // namespace hookeye
