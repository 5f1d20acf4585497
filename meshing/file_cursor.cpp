#include "meshing/file_cursor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye::detail {
namespace {

constexpr std::string_view kBlanks = " \t\r\n\f\v";

}  // namespace

bool is_real(std::string_view field, double& value) {
  if (field.starts_with('+')) field.remove_prefix(1);
  const char* const end = field.data() + field.size();
  const auto [stop, error] = std::from_chars(field.data(), end, value);
  return error == std::errc() && stop == end && std::isfinite(value);
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

FileCursor::FileCursor(const std::filesystem::path& file)
    : name_(file.string()), bytes_(read_text(file)) {}

std::string_view FileCursor::line() {
  line_ += ended_;
  const size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
  std::string_view out = std::string_view(bytes_).substr(at_, end - at_);
  at_ = std::min(end + 1, bytes_.size());
  ended_ = end < bytes_.size();
  if (out.ends_with('\r')) out.remove_suffix(1);
  return out;
}

std::string_view FileCursor::word() {
  line_ += ended_;
  ended_ = 0;
  const size_t begin = std::min(bytes_.find_first_not_of(kBlanks, at_), bytes_.size());
  line_ += static_cast<int>(std::count(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                                       bytes_.begin() + static_cast<std::ptrdiff_t>(begin), '\n'));
  at_ = std::min(bytes_.find_first_of(kBlanks, begin), bytes_.size());
  return std::string_view(bytes_).substr(begin, at_ - begin);
}

double FileCursor::real() {
  const std::string_view field = word();
  if (field.empty()) ends();
  double value = 0.0;
  if (!is_real(field, value))
    fault(fmt::format("'{}' is no finite number", field), "a finite number");
  return value;
}

void FileCursor::ends() const {
  throw InputError({name_}, "ends before what it announces", "a complete file");
}

void FileCursor::fault(const std::string& wrong, const std::string& right, bool binary) const {
  throw InputError({name_, binary ? 0 : line_}, wrong, right);
}

}  // namespace hookeye::detail
