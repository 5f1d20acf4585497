// Captures of searches that end in one effect alone.
#pragma once

#include "tests/estimation/small_capture.h"

namespace hookeye::test {

/// `hidden` and the loads `more` after a pull and a bend.
inline SmallCapture hiding(const std::string& hidden, const char* more) {
  return {.hidden = "hidden:\n  - " + hidden + "\n", .loads = more};
}

inline const char* const kPressAndTwist = "  press: {move: [0, 0, -0.06]}\n  twist: {rotate: 20}\n";

}  // namespace hookeye::test
