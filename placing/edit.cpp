#include "placing/edit.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "capture_io/capture.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

/// Ten digits; what rounding makes of zero is 0.
std::string number(double x, double scale) {
  return std::abs(x) < 1e-10 * scale ? "0" : fmt::format("{:.10g}", x);
}

std::string list(const Eigen::Vector3d& v, double scale) {
  return fmt::format("[{}, {}, {}]", number(v.x(), scale), number(v.y(), scale),
                     number(v.z(), scale));
}

bool same(const YamlNode& a, const YamlNode& b) {
  const auto same_entry = [](const YamlNode::Entry& x, const YamlNode::Entry& y) {
    return x.key == y.key && same(x.value, y.value);
  };
  return a.kind == b.kind && a.text == b.text &&
         std::equal(a.items.begin(), a.items.end(), b.items.begin(), b.items.end(), same) &&
         std::equal(a.entries.begin(), a.entries.end(), b.entries.begin(), b.entries.end(),
                    same_entry);
}

/// The tree without body.placement.
YamlNode others_of(YamlNode root) {
  for (YamlNode::Entry& top : root.entries)
    if (top.key == "body")
      std::erase_if(top.value.entries,
                    [](const YamlNode::Entry& entry) { return entry.key == "placement"; });
  return root;
}

class Text {
 public:
  explicit Text(const std::string& text) : text_(text) {
    for (size_t i = 0; i < text.size(); ++i)
      if (i == 0 || text[i - 1] == '\n') lines_.push_back(i);
  }
  const std::string& str() const { return text_; }
  /// Of a line, counted from 1; behind the last one the end.
  size_t line(int number) const {
    const auto i = static_cast<size_t>(number - 1);
    return i < lines_.size() ? lines_[i] : text_.size();
  }
  size_t offset(const Place& place) const {
    return std::min(line(place.line) + static_cast<size_t>(place.column - 1), text_.size());
  }
  /// Behind the value that begins at `from` within brackets, or behind a plain word.
  size_t end_of(size_t from) const {
    int depth = 0;
    char quote = 0;
    for (size_t i = from; i < text_.size(); ++i) {
      const char c = text_[i];
      if (quote) {
        if (c == quote) quote = 0;
      } else if (depth > 0 && (c == '"' || c == '\'')) {
        quote = c;
      } else if (c == '#' && i > 0 && std::isspace(static_cast<unsigned char>(text_[i - 1]))) {
        if (depth == 0) return from;
        i = std::min(text_.find('\n', i), text_.size());
      } else if (c == '{' || c == '[') {
        ++depth;
      } else if (c == '}' || c == ']') {
        if (depth == 0) return i;
        if (--depth == 0) return i + 1;
      } else if (depth == 0 && (c == ',' || std::isspace(static_cast<unsigned char>(c)))) {
        return i;
      }
    }
    return text_.size();
  }
  /// The first line from `number` on that stands no deeper than `columns`: the end of a block.
  int block_end(int number, int columns) const {
    int end = number;
    for (int i = number; static_cast<size_t>(i) <= lines_.size(); ++i) {
      const size_t first = text_.find_first_not_of(" \t\r", line(i));
      if (first == std::string::npos || first >= line(i + 1) || text_[first] == '\n') continue;
      const bool deeper = static_cast<int>(first - line(i)) > columns;
      if (!deeper) break;
      if (text_[first] != '#') end = i + 1;
    }
    return end;
  }
  std::string line_end() const { return text_.find("\r\n") == std::string::npos ? "\n" : "\r\n"; }
  std::string replaced(size_t from, size_t to, const std::string& by) const {
    return text_.substr(0, from) + by + text_.substr(to);
  }

 private:
  std::string text_;
  std::vector<size_t> lines_;
};

std::string edited(const Text& text, const YamlNode::Entry& body, const std::string& value) {
  const std::string& raw = text.str();
  const YamlNode::Entry* old = body.value.entry("placement");
  if (old && old->place.line > 0) {
    const size_t begin = text.offset(old->value.place);
    const bool block = old->value.kind == YamlNode::Kind::map && raw[begin] != '{';
    if (!block) return text.replaced(begin, text.end_of(begin), value);
    // `placement:` and deeper lines: they become one.
    const int end = text.block_end(old->place.line + 1, old->place.column - 1);
    const size_t key = text.offset(old->place);
    return text.replaced(key, text.line(end), "placement: " + value + text.line_end());
  }
  const size_t begin = text.offset(body.value.place);
  if (begin < raw.size() && raw[begin] == '{')
    return text.replaced(begin + 1, begin + 1, "placement: " + value + ", ");
  // Right below `body:`, so that comments stay with the keys that they stand above.
  const int indent = body.value.place.column - 1;
  const size_t below = text.line(body.place.line + 1);
  return text.replaced(
      below, below,
      std::string(static_cast<size_t>(indent), ' ') + "placement: " + value + text.line_end());
}

}  // namespace

std::string placement_text(const ToldPlacement& placement) {
  std::string rows;
  for (int i = 0; i < 3; ++i) rows += (i ? ", " : "") + list(placement.R.row(i).transpose(), 1.0);
  const double size = std::max(placement.t.norm(), 1e-3);  // what is left of zero is zero
  return fmt::format("{{rotation: [{}], translation: {}{}}}", rows, list(placement.t, size),
                     placement.fit ? ", fit: true" : "");
}

std::string placed_text(const std::string& text, const std::string& file,
                        const ToldPlacement& placement) {
  const YamlNode before = parse_yaml(text, file);
  const YamlNode::Entry* body = before.entry("body");
  const std::string value = placement_text(placement);
  if (body && body->value.kind == YamlNode::Kind::map && !body->value.entries.empty()) {
    try {
      const std::string out = edited(Text(text), *body, value);
      const YamlNode after = parse_yaml(out, file);
      const ToldPlacement got = placement_of_capture(after);
      const double size = std::max(placement.t.norm(), 1e-3);
      if (same(others_of(before), others_of(after)) && got.fit == placement.fit &&
          (got.R - placement.R).norm() < 1e-8 && (got.t - placement.t).norm() <= 1e-8 * size)
        return out;
    } catch (const InputError&) {
      // told below
    }
  }
  throw InputError(body ? body->place : Place{file},
                   "the placement cannot be written into this file without changing more of it",
                   "write it below `body:` by hand: `placement: " + value + "`");
}

std::string store_placed(const fs::path& file, const ToldPlacement& placement, bool dry) {
  const std::string text = placed_text(read_text(file), file.string(), placement);
  // Read as any capture before it has its name: what the reader refuses is not left behind.
  const fs::path tried =
      file.parent_path() / fmt::format(".placed-{}-{}", ::getpid(), file.filename().string());
  struct Removed {
    fs::path file;
    ~Removed() {
      std::error_code ignored;
      fs::remove(file, ignored);
    }
  } const removed{tried};
  write_text(tried, text);
  read_capture(tried);
  if (!dry) write_text(file, text);
  return text;
}

}  // namespace hookeye
