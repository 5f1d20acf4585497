// A numerical failure on its way to whoever called: the shell's exit status 3, Python's exception.
#pragma once

#include <utility>

#include "core/interrupted.h"
#include "core/numerical_failure.h"

namespace hookeye {

struct Failed {
  NumericalFailure failure;
};

/// Throws Interrupted where the work was cancelled, else Failed.
[[noreturn]] inline void fail(NumericalFailure failure) {
  if (cancelled(failure)) throw Interrupted{};
  throw Failed{std::move(failure)};
}

/// Throws Interrupted or Failed where there is a failure instead of a value.
template <class T>
T value_or_fail(Result<T> result) {
  if (!result) fail(std::move(result.error()));
  return *std::move(result);
}

}  // namespace hookeye
