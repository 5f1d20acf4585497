#include "capture_io/yaml_lines.h"

#include <algorithm>
#include <cctype>

namespace hookeye {
namespace {

bool blank(char c) { return std::isspace(static_cast<unsigned char>(c)); }

}  // namespace

YamlLines::YamlLines(const std::string& text) : text_(text) {
  for (size_t i = 0; i < text.size(); ++i)
    if (i == 0 || text[i - 1] == '\n') lines_.push_back(i);
}

size_t YamlLines::line(int number) const {
  const auto i = static_cast<size_t>(number - 1);
  return i < lines_.size() ? lines_[i] : text_.size();
}

int YamlLines::line_of(size_t offset) const {
  return static_cast<int>(std::upper_bound(lines_.begin(), lines_.end(), offset) - lines_.begin());
}

size_t YamlLines::offset(const Place& place) const {
  return std::min(line(place.line) + static_cast<size_t>(std::max(place.column - 1, 0)),
                  text_.size());
}

bool YamlLines::begins(const YamlNode& node, const std::string& characters) const {
  const size_t at = offset(node.place);
  return node.kind != YamlNode::Kind::null && at < text_.size() &&
         characters.find(text_[at]) != std::string::npos;
}

size_t YamlLines::end_of(size_t from, bool flow) const {
  if (from < text_.size() && std::string("{[\"'").find(text_[from]) == std::string::npos)
    return end_of_plain(from, flow);
  int depth = 0;
  char quote = 0;
  for (size_t i = from; i < text_.size(); ++i) {
    const char c = text_[i];
    if (quote) {
      if (quote == '"' && c == '\\')
        ++i;
      else if (c == quote && quote == '\'' && i + 1 < text_.size() && text_[i + 1] == '\'')
        ++i;  // two of them stand for one
      else if (c == quote)
        quote = 0;
      if (!quote && depth == 0) return i + 1;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#' && i > 0 && blank(text_[i - 1])) {
      i = std::min(text_.find('\n', i), text_.size());
    } else if (c == '{' || c == '[') {
      ++depth;
    } else if ((c == '}' || c == ']') && --depth == 0) {
      return i + 1;
    }
  }
  return text_.size();
}

size_t YamlLines::end_of_plain(size_t from, bool flow) const {
  size_t i = from;
  for (; i < text_.size() && text_[i] != '\n' && text_[i] != '\r'; ++i) {
    if (text_[i] == '#' && i > 0 && blank(text_[i - 1])) break;
    if (flow && std::string(",{}[]").find(text_[i]) != std::string::npos) break;
  }
  while (i > from && blank(text_[i - 1])) --i;
  return i;
}

int YamlLines::block_end(int number, int columns, bool holds_list) const {
  int end = number;
  for (int i = number; static_cast<size_t>(i) <= lines_.size(); ++i) {
    const size_t first = text_.find_first_not_of(" \t\r", line(i));
    if (first == std::string::npos || first >= line(i + 1) || text_[first] == '\n') continue;
    const int column = static_cast<int>(first - line(i));
    const bool item = text_[first] == '-' && (first + 1 == text_.size() || blank(text_[first + 1]));
    const bool deeper = column > columns || (holds_list && item && column == columns);
    if (text_[first] != '#' && !deeper) break;
    if (text_[first] != '#') end = i + 1;
  }
  return end;
}

int YamlLines::above_comments(int number) const {
  while (number > 2 && text_[line(number - 1)] == '#') --number;
  return number;
}

size_t YamlLines::dash_before(size_t offset) const {
  const size_t dash =
      offset == 0 ? std::string::npos : text_.find_last_not_of(" \t\r\n", offset - 1);
  return dash == std::string::npos ? 0 : dash;
}

std::string YamlLines::line_end() const {
  return text_.find("\r\n") == std::string::npos ? "\n" : "\r\n";
}

std::string YamlLines::replaced(size_t from, size_t to, const std::string& by) const {
  return text_.substr(0, from) + by + text_.substr(to);
}

}  // namespace hookeye
