// How the program and a helper talk: bytes lie in a file in memory that both have open, and a
// socket tells how many there are. (Through the socket itself, megabytes would take a change from
// one process to the other for every 200 kB.)
#pragma once

#include <chrono>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

namespace hookeye::detail {

/// The ends of a helper.
inline constexpr int kHelperSocket = 3, kHelperMemory = 4;

struct Channel {
  int socket = -1, memory = -1;
};

/// First byte of an answer.
enum class Answer : char { result = 0, input_error, no_memory, failed };

/// The pieces one after the other. False: the other side is gone.
bool send_message(const Channel& channel, std::initializer_list<std::string_view> pieces);
/// Empty: the other side is gone or mad, or nothing came until `deadline`.
std::optional<std::string> receive_message(
    const Channel& channel, std::optional<std::chrono::steady_clock::time_point> deadline = {});

}  // namespace hookeye::detail
