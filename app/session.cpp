#include "app/session.h"

#include <spdlog/spdlog.h>

namespace hookeye {

void Session::warn(const std::string& sentence) {
  spdlog::warn("{}", sentence);
  warnings.push_back(sentence);
}

}  // namespace hookeye
