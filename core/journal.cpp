#include "core/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "core/fingerprint.h"
#include "core/input_error.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

/// A record stands behind a line that tells its bytes and their fingerprint: "1234 xxh3:0f9a...".
std::string framed(const std::string& record) {
  return fmt::format("{} {}\n{}\n", record.size(), fingerprint_of(record), record);
}

struct Piece {
  size_t at = 0, size = 0;  ///< bytes
  std::string mark;         ///< their fingerprint
};

/// The whole records of `text`, one behind the other.
std::vector<Piece> pieces_of(const std::string& text) {
  std::vector<Piece> out;
  for (size_t at = 0; at < text.size();) {
    const size_t end = text.find('\n', at), space = text.find(' ', at);
    if (end == std::string::npos || space > end) break;
    const std::string told = text.substr(at, space - at);
    if (told.empty() || told.size() > 12 ||
        told.find_first_not_of("0123456789") != std::string::npos)
      break;
    const Piece piece{end + 1, std::stoull(told), text.substr(space + 1, end - space - 1)};
    if (piece.at + piece.size >= text.size() || text[piece.at + piece.size] != '\n') break;
    if (fingerprint_of(text.substr(piece.at, piece.size)) != piece.mark) break;
    out.push_back(piece);
    at = piece.at + piece.size + 1;
  }
  return out;
}

/// Bytes of a file that were there.
size_t take_from(int handle, char* to, size_t size, size_t at) {
  size_t done = 0;
  while (done < size) {
    const ssize_t n = ::pread(handle, to + done, size - done, static_cast<off_t>(at + done));
    if (n == 0 || (n < 0 && errno != EINTR)) break;
    if (n > 0) done += static_cast<size_t>(n);
  }
  return done;
}

/// Of a file from `at` on.
std::string rest_of(int handle, size_t at) {
  const off_t end = ::lseek(handle, 0, SEEK_END);
  std::string text(end > static_cast<off_t>(at) ? static_cast<size_t>(end) - at : 0, '\0');
  text.resize(take_from(handle, text.data(), text.size(), at));
  return text;
}

}  // namespace

struct Journal::Impl {
  fs::path file;
  std::string made_for;
  std::vector<Piece> records;  ///< without the first of the file, which is `made_for`
  size_t end = 0;              ///< of the last whole record
  int handle = -1;
  bool cut = false;  ///< nothing stands behind `end`

  ~Impl() {
    if (handle >= 0) ::close(handle);
  }

  void load() {
    std::error_code none;
    if (!fs::is_regular_file(file, none)) return;
    open(O_RDWR);
    const std::string text = rest_of(handle, 0);
    auto all = pieces_of(text);
    if (all.empty() || text.compare(all[0].at, all[0].size, made_for) != 0) return;
    end = all.back().at + all.back().size + 1;
    records.assign(all.begin() + 1, all.end());
  }

  void open(int flags) {
    handle = ::open(file.c_str(), flags | O_CLOEXEC, 0644);
    if (handle < 0) throw cannot_write(file.string(), std::strerror(errno));
  }

  /// Throws where the file does not stand under its name any more.
  void demand_file() const {
    struct stat ours {
    }, there{};
    if (::fstat(handle, &ours) == 0 && ::stat(file.c_str(), &there) == 0 &&
        ours.st_dev == there.st_dev && ours.st_ino == there.st_ino)
      return;
    throw InputError({file.parent_path().string()},
                     fmt::format("this folder, or the file {} in it, was removed or moved while "
                                 "it was used",
                                 file.filename().string()),
                     "leave it where it is until the command has ended; start the command again");
  }

  void put(const std::string& record) {
    if (!cut && ::ftruncate(handle, static_cast<off_t>(end)) != 0)
      throw cannot_write(file.string(), std::strerror(errno));
    cut = true;
    const std::string text = framed(record);
    for (size_t done = 0; done < text.size();) {
      const ssize_t n =
          ::pwrite(handle, text.data() + done, text.size() - done, static_cast<off_t>(end + done));
      if (n < 0 && errno != EINTR) {
        cut = false;
        throw cannot_write(file.string(), std::strerror(errno));
      }
      if (n > 0) done += static_cast<size_t>(n);
    }
    records.push_back(
        {end + text.size() - record.size() - 1, record.size(), fingerprint_of(record)});
    end += text.size();
  }
};

Journal::Journal(fs::path file, std::string made_for) : impl_(std::make_unique<Impl>()) {
  impl_->file = std::move(file);
  impl_->made_for = std::move(made_for);
  impl_->load();
}
Journal::~Journal() = default;
Journal::Journal(Journal&&) noexcept = default;

size_t Journal::size() const { return impl_->records.size(); }

std::string Journal::read(size_t record) const {
  const Piece& piece = impl_->records.at(record);
  std::string out(piece.size, '\0');
  const bool whole = take_from(impl_->handle, out.data(), piece.size, piece.at) == piece.size;
  if (whole && fingerprint_of(out) == piece.mark) return out;
  impl_->demand_file();
  throw InputError({impl_->file.string()}, "the file was changed while it was used",
                   "start the command again");
}

size_t Journal::add(const std::string& record) {
  if (impl_->handle < 0) impl_->open(O_RDWR | O_CREAT);
  impl_->demand_file();
  if (impl_->end == 0) {
    impl_->put(impl_->made_for);
    impl_->records.clear();
  }
  impl_->put(record);
  return size() - 1;
}

struct JournalReader::Impl {
  fs::path file;
  std::string made_for;
  std::vector<Piece> records;
  size_t end = 0;  ///< of the last whole record
  int handle = -1;
  bool strange = false;

  ~Impl() {
    if (handle >= 0) ::close(handle);
  }
};

JournalReader::JournalReader(fs::path file, std::string made_for)
    : impl_(std::make_unique<Impl>()) {
  impl_->file = std::move(file);
  impl_->made_for = std::move(made_for);
}
JournalReader::~JournalReader() = default;
JournalReader::JournalReader(JournalReader&&) noexcept = default;

// Opened each time: a network file system asks its server then how long the file is by now.
void JournalReader::look() {
  const int handle = ::open(impl_->file.c_str(), O_RDONLY | O_CLOEXEC);
  if (handle < 0) return;  // what was read stays open
  if (impl_->handle >= 0) ::close(impl_->handle);
  impl_->handle = handle;
  const std::string text = rest_of(handle, impl_->end);
  std::vector<Piece> all = pieces_of(text);
  if (all.empty()) return;
  const size_t whole = all.back().at + all.back().size + 1;
  auto first = all.begin();
  if (impl_->end == 0) {
    impl_->strange = text.compare(first->at, first->size, impl_->made_for) != 0;
    if (impl_->strange) return;
    ++first;
  }
  for (; first != all.end(); ++first) {
    impl_->records.push_back(*first);
    impl_->records.back().at += impl_->end;
  }
  impl_->end += whole;
}

bool JournalReader::strange() const { return impl_->strange; }

size_t JournalReader::size() const { return impl_->records.size(); }

std::optional<std::string> JournalReader::read(size_t record) const {
  const Piece& piece = impl_->records.at(record);
  std::string out(piece.size, '\0');
  if (take_from(impl_->handle, out.data(), piece.size, piece.at) != piece.size ||
      fingerprint_of(out) != piece.mark)
    return {};
  return out;
}

}  // namespace hookeye
