// The program: options in, one command, an exit status out.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace hookeye {

enum Exit { kDone = 0, kInternal = 1, kBadInput = 2, kNumericalFailure = 3, kInterrupted = 130 };

/// What is different for one of several processes that do the same work together (app/mpi).
struct Company {
  std::string name = "hookeye";       ///< of the program, in its help
  std::vector<std::string> commands;  ///< that can be shared; empty: all
  int threads = 0;                    ///< where the user tells none; 0: all cores
  /// Where this process keeps what the user wants in that folder. Null: there.
  std::function<std::string(const std::string& folder)> own_folder;
  /// What --solver may be, its default first; none: there is no such option.
  std::vector<std::string> solvers;
  /// Told what it is before anything is solved. Throws InputError.
  std::function<void(const std::string& solver)> solve_by;
  /// The command line is understood, nothing is done yet.
  std::function<void(int threads)> begins;
};

/// Runs the command and tells what is wrong; throws nothing. Once a process.
int program(int argc, char** argv, const Company& company = {});

/// Ends the process without waiting for its threads: where memory was out one of OpenBLAS asks for
/// its own for ever, and exit() waits for it.
[[noreturn]] void leave_at_once(int status);

}  // namespace hookeye
