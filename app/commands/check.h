// What `hookeye check` does, for commands that end with it.
#pragma once

#include <string>

#include "app/session.h"

namespace hookeye {

/// As `hookeye check CAPTURE -o OUT`; `out` may be empty. Fills session.document.
void check_capture(const std::string& capture, const std::string& out, Session& session);

}  // namespace hookeye
