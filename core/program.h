// A program of others that the user has installed, run to its end.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace hookeye {

/// Starts words[0] (looked for in PATH, unless it is a path) with nothing on standard input, its
/// output in `out` and its errors in `errors`, open files of the caller; -1: nowhere. It has the
/// signals that a shell would give it. 0, or the errno by which it failed.
int start_program(std::vector<std::string> words, int out, int errors, pid_t& child);

struct ProgramEnd {
  bool found = true;   ///< false: there is no such program in PATH
  int status = 0;      ///< of its exit; 128 and the signal that ended it; -1: it was told to end
  std::string errors;  ///< what it wrote to standard error
};

/// Runs words[0] (looked for in PATH) with nothing on standard input. `output` is handed what comes
/// on standard output, in pieces; where it returns false the program is ended. A thrown exception
/// ends it, too. Throws std::runtime_error where the system has no process or pipe left.
ProgramEnd run_program(std::vector<std::string> words,
                       const std::function<bool(std::string_view)>& output);

}  // namespace hookeye
