// Where the values of a yaml text begin and end in it; for yaml_edit alone.
#pragma once

#include <string>
#include <vector>

#include "capture_io/yaml_tree.h"

namespace hookeye {

/// A text by its lines, counted from 1, and by bytes, counted from 0.
class YamlLines {
 public:
  explicit YamlLines(const std::string& text);
  const std::string& str() const { return text_; }
  /// First byte of a line; behind the last line the end.
  size_t line(int number) const;
  int line_of(size_t offset) const;
  size_t offset(const Place& place) const;
  /// Whether the value begins with one of these characters.
  bool begins(const YamlNode& node, const std::string& characters) const;
  /// Behind the value that begins at `from`: in brackets, in quotes, or plain words. `flow`: it
  /// stands within brackets.
  size_t end_of(size_t from, bool flow) const;
  /// The first line from `number` on that stands no deeper than `columns`: the end of a block, but
  /// for comments and empty lines behind it. `holds_list`: dashes at that column are of it.
  int block_end(int number, int columns, bool holds_list) const;
  /// Of a line, the first of the comments that stand right above it.
  int above_comments(int number) const;
  /// The dash of the list's item whose value begins at `offset`.
  size_t dash_before(size_t offset) const;
  std::string line_end() const;
  std::string replaced(size_t from, size_t to, const std::string& by) const;

 private:
  size_t end_of_plain(size_t from, bool flow) const;
  std::string text_;
  std::vector<size_t> lines_;
};

}  // namespace hookeye
