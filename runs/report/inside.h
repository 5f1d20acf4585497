// What may be read of a run for somebody else: only what lies in its folder.
#pragma once

#include <filesystem>

namespace hookeye {

/// Whether `file` is there and, links resolved, lies in `folder`. A link out of the run, or what
/// lies behind one, does not.
bool inside(const std::filesystem::path& folder, const std::filesystem::path& file);

/// The first link anywhere in `folder` that leads out of it, or to nothing; "": none.
std::filesystem::path link_out_of(const std::filesystem::path& folder);

}  // namespace hookeye
