// A file in memory, read from front to back, text and bytes in turn; faults carry its line.
#pragma once

#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/input_error.h"

namespace hookeye::detail {

/// The number that is all of `field`, with or without a plus; false: it is none, or not finite.
bool is_real(std::string_view field, double& value);
/// Lower-case ASCII.
std::string lower(std::string_view text);

class FileCursor {
 public:
  /// Throws InputError where the file cannot be read.
  explicit FileCursor(const std::filesystem::path& file);

  /// All that is not read yet.
  std::string_view rest() const { return std::string_view(bytes_).substr(at_); }
  void skip(size_t bytes) { at_ += std::min(bytes, rest().size()); }
  /// The rest of this line, without its end. Empty at the end of the file, too.
  std::string_view line();
  /// The next word, behind blanks and ends of lines; empty: there is none.
  std::string_view word();
  /// A number of binary data, its bytes turned where `swap`. Faults at the end of the file.
  template <class T>
  T number(bool swap = false) {
    if (rest().size() < sizeof(T)) ends();
    char bytes[sizeof(T)];
    for (size_t i = 0; i < sizeof(T); ++i) bytes[swap ? sizeof(T) - 1 - i : i] = bytes_[at_ + i];
    at_ += sizeof(T);
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
  }
  /// The next word as a number. Faults where it is none, or not finite.
  double real();

  [[noreturn]] void ends() const;
  /// At the line of what was read last; `binary`: of the file as a whole.
  [[noreturn]] void fault(const std::string& wrong, const std::string& right,
                          bool binary = false) const;

 private:
  std::string name_, bytes_;
  size_t at_ = 0;
  int line_ = 1, ended_ = 0;  ///< of what was read last, and ends of lines behind it
};

}  // namespace hookeye::detail
