// Ctrl-C: the first asks the work to stop at the next safe place, the second ends the process.
#pragma once

#include <atomic>

#include "core/interrupted.h"

namespace hookeye {

/// Set by SIGINT and SIGTERM; every long loop polls it (EquilibriumOptions, FitOptions ...).
const std::atomic<bool>& interrupted();
/// Begins to listen. All threads have the signals blocked, from before main().
void watch_interrupts();

}  // namespace hookeye
