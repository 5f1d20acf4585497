#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "capture_io/run.h"

namespace hookeye {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const char* what) {
  throw std::system_error(errno, std::generic_category(),
                          fmt::format("cannot {} {}", what, file.string()));
}

}  // namespace

void write_text(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path temporary =
      file.parent_path() / fmt::format(".tmp-{}-{}", ::getpid(), file.filename().string());
  const int handle = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (handle < 0) fail(temporary, "write");
  size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = ::write(handle, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int why = errno;
      ::close(handle);
      ::unlink(temporary.c_str());
      errno = why;
      fail(file, "write");
    }
    done += static_cast<size_t>(n);
  }
  // Without the sync a power cut after the rename could leave an empty file under the final name.
  ::fsync(handle);
  ::close(handle);
  std::filesystem::rename(temporary, file);
}

std::string read_text(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    throw InputError({file.string()}, "there is no such file", "check the name and its folder");
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw InputError({file.string()}, "the file cannot be opened", "check its permissions");
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace hookeye
