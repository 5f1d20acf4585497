#include "core/input_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <numeric>
#include <utility>
#include <vector>

namespace hookeye {
namespace {

std::string message(const Place& place, const std::string& wrong, const std::string& right) {
  const std::string where = place.str();
  return fmt::format("{}{}{}{}{}", where, where.empty() ? "" : ": ", wrong,
                     right.empty() ? "" : "\n  ", right);
}

/// Edit distance with neighbours swapped counting as one error (optimal string alignment).
size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  std::iota(last.begin(), last.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        now[j] = std::min(now[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, now);
  }
  return last[b.size()];
}

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// "neohooke" of "Neo-Hooke".
std::string letters(const std::string& text) {
  std::string out;
  for (const char c : lower_case(text))
    if (std::isalnum(static_cast<unsigned char>(c))) out += c;
  return out;
}

/// One is the other's start: "fixed" of "fix", "neohooke" of "neohookean".
bool is_start(const std::string& one, const std::string& other) {
  return std::min(one.size(), other.size()) >= 3 &&
         (one.starts_with(other) || other.starts_with(one));
}

}  // namespace

InputError told_at(const Place& named, const InputError& error) {
  if (error.place().line > 0 || named.file.empty()) return error;
  const std::string name = std::filesystem::path(error.place().file).filename().string();
  return {named, fmt::format("{}: {}", name, error.wrong()), error.right()};
}

InputError cannot_write(const std::string& file, const std::string& why) {
  return {{file},
          why.empty() ? "cannot be written" : "cannot be written: " + why,
          "choose a folder that is there and writable, on a disk with room"};
}

std::string Place::str() const {
  if (line <= 0) return file;
  if (column <= 0) return fmt::format("{}:{}", file, line);
  return fmt::format("{}:{}:{}", file, line, column);
}

InputError::InputError(Place place, std::string wrong, std::string right)
    : std::runtime_error(message(place, wrong, right)),
      place_(std::move(place)),
      wrong_(std::move(wrong)),
      right_(std::move(right)) {}

std::string nearest_name_of(const std::string& word, const std::string* begin,
                            const std::string* end) {
  // Longer words than any key are no slips of the pen, and would cost quadratic time.
  if (word.size() > 100) return "";
  const std::string* best = nullptr;
  size_t best_distance = word.size() / 3 + 1;
  for (const std::string* name = begin; name != end; ++name) {
    if (name->size() > 200) continue;
    size_t distance = edit_distance(lower_case(word), lower_case(*name));
    if (is_start(letters(word), letters(*name))) distance = std::min<size_t>(distance, 1);
    if (distance < best_distance) {
      best_distance = distance;
      best = name;
    }
  }
  return best ? *best : "";
}

}  // namespace hookeye
