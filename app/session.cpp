#include "app/session.h"

#include <spdlog/spdlog.h>

#include "app/interrupt.h"

namespace hookeye {

void Session::warn(const std::string& sentence) {
  spdlog::warn("{}", sentence);
  warnings.push_back(sentence);
}

void fail(NumericalFailure failure) {
  if (interrupted()) throw Interrupted{};
  throw Failed{std::move(failure)};
}

}  // namespace hookeye
