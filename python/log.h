// The program's log lines on their way to Python's `logging`.
#pragma once

namespace hookeye {

/// Once, when the module is loaded: lines are kept from then on until drain_log().
void keep_log();
/// Debug lines are made only where the logger `hookeye` wants them. Needs the interpreter's lock.
void follow_level();
/// Hands what is kept to logging.getLogger("hookeye"). Needs the interpreter's lock. What a handler
/// throws is thrown.
void drain_log();

}  // namespace hookeye
