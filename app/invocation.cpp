#include "app/invocation.h"

#include <algorithm>
#include <string_view>

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

std::vector<std::string> take_handed_on(int& argc, char** argv) {
  const auto hands_on = [](std::string_view word) { return word == "batch"; };
  char** const end = argv + argc;
  char** const command =
      std::find_if(argv + 1, end, [](const char* word) { return word[0] != '-'; });
  if (argc < 2 || command == end || !hands_on(*command)) return {};
  char** const mark =
      std::find_if(command, end, [](std::string_view word) { return word == "--"; });
  if (mark == end) return {};
  argc = static_cast<int>(mark - argv);
  return {mark + 1, end};
}

std::string invocation() { return command_line; }

}  // namespace hookeye
