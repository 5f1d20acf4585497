// The numbers failed (no equilibrium, no convergence): exit status 3, never a crash.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace hookeye {

/// Returned (never thrown) by solvers: where it stopped and why.
struct NumericalFailure {
  enum class Kind {
    numbers,    ///< no equilibrium, no convergence, no model that stands
    cancelled,  ///< somebody asked for the end
    no_memory,  ///< core/memory_left.h
  };
  std::string example;         ///< name of the example, or ""
  double load_fraction = 0.0;  ///< largest fraction of the load at which equilibrium was found
  std::string reason;          ///< one sentence, with the element where one is at fault
  Kind kind = Kind::numbers;
};

inline bool cancelled(const NumericalFailure& failure) {
  return failure.kind == NumericalFailure::Kind::cancelled;
}

inline bool out_of_memory(const NumericalFailure& failure) {
  return failure.kind == NumericalFailure::Kind::no_memory;
}

/// What a computation gives, or why it gives nothing (std::expected of C++23):
///   auto fitted = fit(...);
///   if (!fitted) return failure_of(fitted);
///   use(*fitted);
template <class T>
using Result = tl::expected<T, NumericalFailure>;

/// Returned where there is no value, for a Result of any type.
inline tl::unexpected<NumericalFailure> no_result(NumericalFailure why) {
  return tl::unexpected<NumericalFailure>(std::move(why));
}
inline tl::unexpected<NumericalFailure> stopped() {
  return no_result({"", 0.0, "cancelled", NumericalFailure::Kind::cancelled});
}
template <class T>
tl::unexpected<NumericalFailure> failure_of(const Result<T>& result) {
  return no_result(result.error());
}

}  // namespace hookeye
