// Thrown where the user's Ctrl-C ends the work.
#pragma once

namespace hookeye {

struct Interrupted {};

}  // namespace hookeye
