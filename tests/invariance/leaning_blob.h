// The small capture of the suite: a leaning blob whose weight is not told.
#pragma once

#include <filesystem>

namespace hookeye::test {

/// The capture as all tellings start from: with a mesh of its own and regions as lists of faces.
/// Made once a process.
const std::filesystem::path& first_telling();

}  // namespace hookeye::test
