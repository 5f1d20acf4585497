// The exact command that makes a step, for run.json and the page.
#pragma once

#include <string>
#include <vector>

namespace hookeye {

/// Called once by main().
void remember_invocation(int argc, char** argv);
/// The command line as it may be given to a shell again.
std::string invocation();
std::string shell_word(const std::string& word);
/// Takes what stands behind `--` off the command line of a command that hands it on: `batch`.
std::vector<std::string> take_handed_on(int& argc, char** argv);

}  // namespace hookeye
