// A placement written into a capture that somebody wrote: nothing else of it changes.
#pragma once

#include <filesystem>
#include <string>

#include "capture_io/placement.h"

namespace hookeye {

/// {rotation: [..], translation: [..]} on one line; with `fit: true` where it is to be fitted.
std::string placement_text(const ToldPlacement& placement);

/// `text` of a capture with the placement in it. The line of an old placement is replaced, else one
/// is added below `body:`. Comments, order and line ends stay. Throws InputError with the place in
/// `file` where the text cannot be edited safely, and with what to write by hand.
std::string placed_text(const std::string& text, const std::string& file,
                        const ToldPlacement& placement);

/// placed_text() of the file, written whole after read_capture() took it; else nothing changes.
/// `dry`: only tried. Returns the text.
std::string store_placed(const std::filesystem::path& file, const ToldPlacement& placement,
                         bool dry);

}  // namespace hookeye
