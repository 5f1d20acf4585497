#include "app/invocation.h"

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

}  // namespace hookeye
