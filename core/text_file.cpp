#include "core/text_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "core/input_error.h"

namespace hookeye {
namespace {

/// Returns why not, or "".
std::string write_and_close(int handle, const std::string& text) {
  if (handle < 0) return std::strerror(errno);
  int why = 0;
  for (size_t done = 0; done < text.size() && !why;) {
    const ssize_t n = ::write(handle, text.data() + done, text.size() - done);
    if (n >= 0)
      done += static_cast<size_t>(n);
    else if (errno != EINTR)
      why = errno;
  }
  // Without the sync a power cut after the rename could leave an empty file under the final name.
  ::fsync(handle);
  if (::close(handle) != 0 && !why) why = errno;
  return why ? std::strerror(why) : "";
}

}  // namespace

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::error_code failed;
  const auto status = std::filesystem::status(file, failed);
  // A pipe or a device is written to; a rename would take its place.
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    const std::string why = write_and_close(::open(file.c_str(), O_WRONLY | O_CLOEXEC), text);
    if (!why.empty()) throw cannot_write(file.string(), why);
    return;
  }
  const std::filesystem::path temporary =
      file.parent_path() / fmt::format(".tmp-{}-{}", ::getpid(), file.filename().string());
  const int handle = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  std::string why = write_and_close(handle, text);
  if (why.empty()) {
    std::filesystem::rename(temporary, file, failed);
    if (failed) why = failed.message();
  }
  if (why.empty()) return;
  std::filesystem::remove(temporary, failed);
  throw cannot_write(file.string(), why);
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
