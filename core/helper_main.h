// The other side of helper.h: what a helper's main() calls.
#pragma once

#include <functional>
#include <string>

#include "core/wire.h"

namespace hookeye {

/// Answers requests until the program goes. `answer` may throw InputError. Returns the exit status.
int serve(const std::function<std::string(Unpacker&)>& answer);

/// For the rest of this request: memory [bytes] over what the helper has now, and seconds of
/// computing over what it has used.
void allow(double memory, double seconds);

/// From here on Ctrl-C ends the helper too: for one that computes long and is asked once.
void die_of_interrupts();

}  // namespace hookeye
