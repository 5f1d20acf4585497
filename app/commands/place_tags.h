// Pairs out of tags that are seen in the photos at rest.
#pragma once

#include <string>
#include <vector>

#include "app/session.h"
#include "placing/pairs.h"

namespace hookeye {

/// The corners of the tags of `file` in the first photo of each camera that shows one. `at_rest`:
/// the capture with the examples that are looked at. Warns of tags that no photo shows; throws
/// InputError where none is seen.
std::vector<PickedPair> pairs_of_tags(const std::string& file, const std::string& dictionary,
                                      const Capture& at_rest, Session& session);

}  // namespace hookeye
