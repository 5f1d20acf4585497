#include "core/message.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>

namespace hookeye::detail {
namespace {

using Deadline = std::optional<std::chrono::steady_clock::time_point>;

/// Repeats what may do less than is asked of it, or be interrupted by a signal.
template <class Transfer>
bool all_of(size_t count, const Transfer& transfer) {
  for (size_t done = 0; done < count;) {
    const ssize_t now = transfer(done, count - done);
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) return false;
    done += static_cast<size_t>(now);
  }
  return true;
}

bool wait_for_bytes(int socket, const Deadline& deadline) {
  while (true) {
    int left = -1;
    if (deadline) {
      const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(
                          *deadline - std::chrono::steady_clock::now())
                          .count();
      left = static_cast<int>(std::clamp<long long>(ms, 0, 1'000'000'000));
    }
    pollfd one{socket, POLLIN, 0};
    const int ready = ::poll(&one, 1, left);
    if (ready < 0 && errno == EINTR) continue;
    return ready > 0;
  }
}

}  // namespace

bool send_message(const Channel& channel, std::initializer_list<std::string_view> pieces) {
  if (::ftruncate(channel.memory, 0) != 0) return false;
  uint64_t size = 0;
  for (const std::string_view piece : pieces) {
    const bool laid_down = all_of(piece.size(), [&](size_t done, size_t left) {
      return ::pwrite(channel.memory, piece.data() + done, left, static_cast<off_t>(size + done));
    });
    if (!laid_down) return false;
    size += piece.size();
  }
  return all_of(sizeof size, [&](size_t done, size_t left) {
    return ::send(channel.socket, reinterpret_cast<const char*>(&size) + done, left, MSG_NOSIGNAL);
  });
}

std::optional<std::string> receive_message(const Channel& channel, Deadline deadline) {
  uint64_t size = 0;
  const bool told = all_of(sizeof size, [&](size_t done, size_t left) -> ssize_t {
    if (!wait_for_bytes(channel.socket, deadline)) return 0;
    return ::recv(channel.socket, reinterpret_cast<char*>(&size) + done, left, 0);
  });
  struct stat there {};
  if (!told || ::fstat(channel.memory, &there) != 0 || size != static_cast<uint64_t>(there.st_size))
    return {};
  std::string bytes(size, '\0');
  const bool whole = all_of(bytes.size(), [&](size_t done, size_t left) {
    return ::pread(channel.memory, bytes.data() + done, left, static_cast<off_t>(done));
  });
  if (!whole) return {};
  if (::ftruncate(channel.memory, 0) != 0) return {};  // the room is the machine's again
  return bytes;
}

}  // namespace hookeye::detail
