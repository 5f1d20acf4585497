#include "capture_io/left_open.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace hookeye {

namespace {

int line_of(const std::string& text, size_t at) {
  return 1 + static_cast<int>(
                 std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

/// Line of the last character that is no space.
int last_line(const std::string& text) {
  const size_t last = text.find_last_not_of(" \t\r\n");
  return last == std::string::npos ? 1 : line_of(text, last);
}

bool blank(char c) { return std::strchr(" \t\r\n", c) != nullptr; }

/// Behind the string that begins at `at` with its quote; npos: it does not end.
size_t end_of_string(const std::string& text, size_t at) {
  const char quote = text[at];
  for (size_t i = at + 1; i < text.size(); ++i) {
    if (text[i] == '\\' && quote == '"')
      ++i;
    else if (text[i] == quote)
      return i + 1;
  }
  return std::string::npos;
}

/// Of yaml and json.
std::optional<LeftOpen> open_bracket(const std::string& text) {
  std::vector<size_t> open;
  char before = '\n';  // the last one that is no blank
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    // In the midst of a word a quote is an apostrophe, and # no comment.
    if ((c == '"' || c == '\'') && std::strchr("\n:,[{-", before)) {
      const size_t end = end_of_string(text, i);
      if (end == std::string::npos)
        return LeftOpen{std::string("the quote `") + c + "`", line_of(text, i), last_line(text)};
      i = end - 1;
    } else if (c == '#' && (i == 0 || blank(text[i - 1]))) {
      i = std::min(text.find('\n', i), text.size()) - 1;
      continue;
    } else if (c == '[' || c == '{') {
      open.push_back(i);
    } else if ((c == ']' || c == '}') && !open.empty()) {
      open.pop_back();
    }
    if (c == '\n' || !blank(c)) before = c;
  }
  if (open.empty()) return {};
  return LeftOpen{std::string("`") + text[open.back()] + "`", line_of(text, open.back()),
                  last_line(text)};
}

}  // namespace

std::optional<LeftOpen> left_open(const std::string& text) {
  const size_t xml = text.find("<opencv_storage");
  if (xml == std::string::npos) return open_bracket(text);
  if (text.find("</opencv_storage", xml) != std::string::npos) return {};
  return LeftOpen{"`<opencv_storage>`", line_of(text, xml), last_line(text)};
}

}  // namespace hookeye
