#include "app/invocation.h"

#include <algorithm>

namespace hookeye {
namespace {

std::string command_line = "hookeye";

}  // namespace

std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_-./=:,+@%") == std::string::npos;
  if (plain) return word;
  std::string out = "'";
  for (const char c : word) {
    if (c == '\'')
      out += "'\\''";
    else
      out += c;
  }
  return out + "'";
}

void remember_invocation(int argc, char** argv) {
  command_line = "hookeye";
  for (int i = 1; i < argc; ++i) command_line += " " + shell_word(argv[i]);
}

std::string invocation() { return command_line; }

nlohmann::json versions() {
  nlohmann::json out = {{"hookeye", HOOKEYE_VERSION}, {"compiler", "GCC " __VERSION__}};
  // "Ceres=2.1.0 Eigen=3.4.0", told by CMake: each library's headers stand in one file alone.
  const std::string all = HOOKEYE_LIBRARIES;
  for (size_t at = 0; at < all.size();) {
    const size_t end = std::min(all.find(' ', at), all.size());
    const std::string one = all.substr(at, end - at);
    const size_t equals = one.find('=');
    if (equals != std::string::npos) out[one.substr(0, equals)] = one.substr(equals + 1);
    at = end + 1;
  }
  return out;
}

}  // namespace hookeye
