#include "runs/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hookeye {
namespace {

using Cells = std::vector<std::string>;

constexpr size_t kLeastWidth = 6;

bool inside_character(char byte) { return (static_cast<unsigned char>(byte) & 0xC0) == 0x80; }

/// Characters, not bytes.
size_t columns_of(const std::string& text) {
  return static_cast<size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return !inside_character(c); }));
}

/// The first `columns` characters of `word`, taken out of it.
std::string take(std::string& word, size_t columns) {
  size_t end = 0;
  for (size_t seen = 0; end < word.size(); ++end)
    if (!inside_character(word[end]) && seen++ == columns) break;
  std::string head = word.substr(0, end);
  word.erase(0, end);
  return head;
}

/// Broken between words; `cut`: words that are too long also within.
Cells lines_of(const std::string& text, size_t width, bool cut) {
  if (columns_of(text) <= width) return {text};
  Cells lines = {""};
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find(' ', at), text.size());
    std::string word = text.substr(at, end - at);
    at = end + 1;
    if (word.empty()) continue;
    if (!lines.back().empty() && columns_of(lines.back()) + 1 + columns_of(word) > width)
      lines.emplace_back();
    while (cut && columns_of(word) > width) {
      lines.back() = take(word, width);
      lines.emplace_back();
    }
    lines.back() += (lines.back().empty() ? "" : " ") + word;
  }
  return lines;
}

size_t longest_word(const std::string& text) {
  size_t longest = 0;
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find(' ', at), text.size());
    longest = std::max(longest, columns_of(text.substr(at, end - at)));
    at = end + 1;
  }
  return longest;
}

/// Takes from the widest column, but from none below its `least`.
void shrink(std::vector<size_t>& widths, const std::vector<size_t>& least, size_t width) {
  while (std::accumulate(widths.begin(), widths.end(), 2 * widths.size()) > width) {
    size_t widest = widths.size();
    for (size_t i = 0; i < widths.size(); ++i)
      if (widths[i] > least[i] && (widest == widths.size() || widths[i] > widths[widest]))
        widest = i;
    if (widest == widths.size()) return;
    --widths[widest];
  }
}

/// Words stay whole, for names are there to be copied, unless the table cannot fit with them.
std::vector<size_t> widths_within(const std::vector<Cells>& rows, size_t width) {
  std::vector<size_t> widths, words;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    words.resize(widths.size(), 0);
    for (size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], columns_of(row[i]));
      words[i] = std::max(words[i], longest_word(row[i]));
    }
  }
  shrink(widths, words, width);
  shrink(widths, std::vector<size_t>(widths.size(), kLeastWidth), width);
  return widths;
}

}  // namespace

std::string table(const std::vector<Cells>& rows, size_t width) {
  const std::vector<size_t> widths = widths_within(rows, width);
  std::string text;
  for (const auto& row : rows) {
    std::vector<Cells> cells;
    size_t height = 1;
    for (size_t i = 0; i < row.size(); ++i) {
      cells.push_back(lines_of(row[i], widths[i], true));
      height = std::max(height, cells.back().size());
    }
    for (size_t k = 0; k < height; ++k) {
      std::string line = " ";
      for (size_t i = 0; i < cells.size(); ++i) {
        const std::string cell = k < cells[i].size() ? cells[i][k] : "";
        line += " " + cell + std::string(widths[i] - columns_of(cell) + 1, ' ');
      }
      line.erase(line.find_last_not_of(' ') + 1);
      text += line + "\n";
    }
  }
  return text;
}

std::string wrapped(const std::string& text, size_t indent, size_t width) {
  const std::string first(indent, ' ');
  if (indent + columns_of(text) <= width) return first + text + "\n";
  std::string out;
  for (const auto& line : lines_of(text, width - indent - 2, false))
    out += first + (out.empty() ? "" : "  ") + line + "\n";
  return out;
}

std::string bar(double share, int width) {
  const int full = static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * width));
  return fmt::format("{:4.0f} % {}{}", 100.0 * share, std::string(full, '#'),
                     std::string(width - full, '.'));
}

std::string marked_bar(double value, double mark, double most, int width) {
  const auto cells = [&](double v) {
    return most > 0.0 ? static_cast<int>(std::lround(std::clamp(v / most, 0.0, 1.0) * width)) : 0;
  };
  const int full = cells(value);
  std::string out = std::string(full, '#') + std::string(width - full, '.');
  return out.insert(cells(mark), 1, '|');
}

std::string html_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

}  // namespace hookeye
