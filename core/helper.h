// Programs of our own beside the main one, each with a library that reads files of strangers, is
// slow to load or may end the process it runs in. One request, one answer; what a file does to a
// helper does not reach the program.
#pragma once

#include <filesystem>
#include <string>

#include "core/input_error.h"
#include "core/wire.h"

namespace hookeye {

/// What a helper may take for one request; beyond, it ends.
struct HelperLimits {
  double memory = 512.0 * (1 << 20);  ///< [bytes] over what it has when the request arrives
  double seconds = 1.0;               ///< of computing
};
/// For a file that a library reads: 64 bytes of memory for each of its own, a second for each MiB.
HelperLimits limits_for(const std::filesystem::path& file);

/// For what is not a stranger's.
inline constexpr HelperLimits unlimited{1e15, 1e6};

/// Thrown where a helper crashed, answered nonsense or went beyond its limits.
class HelperDied : public InputError {
 public:
  HelperDied(const InputError& told, bool within_limits, double seconds)
      : InputError(told), within_limits_(within_limits), seconds_(seconds) {}
  /// False: by its limit of computing, or since memory was out. More of the same does no better.
  bool within_limits() const { return within_limits_; }
  double seconds() const { return seconds_; }  ///< of computing, in its whole life

 private:
  bool within_limits_;
  double seconds_;
};

/// One request to libexec/hookeye/NAME.
struct HelperRequest {
  std::string name;
  std::string content;  ///< of a Packer
  HelperLimits limits;
  bool once = false;  ///< the helper is not asked again: its library does not forget
  /// It may compute for long and writes nothing that is kept: interrupt_helpers() ends it. Its
  /// answer() calls die_of_interrupts().
  bool interruptible = false;
  /// What is told where the helper crashes, answers nonsense or goes beyond its limits.
  Place place;
  std::string right;
  std::string damaged = "the file is damaged: it does not hold what it announces";
};

namespace detail {
/// The answer, behind a byte that tells that it is one.
std::string ask_helper(const HelperRequest& request);
}  // namespace detail

/// Starts the helper where it does not run, hands over the request and has `unpack` take the answer
/// from an Unpacker. What the helper finds wrong comes as its InputError. Throws HelperDied, and
/// Interrupted where Ctrl-C ended the helper; std::runtime_error where there is no such program.
template <class Unpack>
auto ask_helper(const HelperRequest& request, const Unpack& unpack) {
  const std::string answer = detail::ask_helper(request);
  try {
    Unpacker from(std::string_view(answer).substr(1));
    auto value = unpack(from);
    from.end();
    return value;
  } catch (const WireFault&) {
    throw InputError(request.place, request.damaged, request.right);
  }
}

/// Ends the helpers of requests that are `interruptible`; those asked later throw Interrupted at
/// once. For Ctrl-C, which reaches the program alone where no terminal sends it to all.
void interrupt_helpers();

/// The folder of the helpers: $HOOKEYE_LIBEXEC, else libexec/hookeye beside the running program (or
/// Python's module), or beside one of the folders that it lies in.
std::filesystem::path helper_folder();

}  // namespace hookeye
