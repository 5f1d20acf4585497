#include "batch/capture_list.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <optional>
#include <sstream>

#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

constexpr const char* kYaml = "capture.yaml";
constexpr int kDeepest = 4;  // folders below one that is told

std::string trimmed(const std::string& text) {
  const size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

std::vector<std::string> matches_of(const std::string& pattern) {
  glob_t found{};
  std::vector<std::string> out;
  if (::glob(pattern.c_str(), GLOB_TILDE | GLOB_BRACE, nullptr, &found) == 0)
    out.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  ::globfree(&found);
  return out;
}

bool is_yaml(const fs::path& file) {
  return file.extension() == ".yaml" || file.extension() == ".yml";
}

/// After its folder; another name than capture.yaml stands behind it.
std::string label_of(const fs::path& yaml) {
  const std::string folder = yaml.parent_path().filename().string();
  return yaml.filename() == kYaml ? folder : folder + "-" + yaml.stem().string();
}

ListedCapture listed(const fs::path& yaml) {
  const fs::path whole = fs::weakly_canonical(yaml);
  return {whole, label_of(whole), {}};
}

void add_below(const fs::path& folder, int depth, std::vector<ListedCapture>& out) {
  if (fs::exists(folder / kYaml)) {
    out.push_back(listed(folder / kYaml));
    return;
  }
  if (depth == kDeepest) return;
  std::vector<fs::path> inner;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_directory() && entry.path().filename().string()[0] != '.')
      inner.push_back(entry.path());
  std::sort(inner.begin(), inner.end());
  for (const fs::path& one : inner) add_below(one, depth + 1, out);
}

/// Captures that one entry of the command line or of a list names.
std::vector<ListedCapture> captures_at(const fs::path& named, const Place& place) {
  const std::string right =
      "a capture's folder or yaml, a folder above captures, or a pattern in quotes";
  std::vector<ListedCapture> out;
  if (fs::is_directory(named)) {
    add_below(named, 0, out);
    if (out.empty())
      throw InputError(place, fmt::format("no capture.yaml lies in {} or below", named.string()),
                       right);
  } else if (fs::exists(named)) {
    if (!is_yaml(named))
      throw InputError(
          place, fmt::format("{} is no capture: its name does not end in .yaml", named.string()),
          right);
    out.push_back(listed(named));
  } else {
    for (const std::string& match : matches_of(named.string()))
      if (fs::is_directory(match))
        add_below(match, 0, out);
      else if (is_yaml(match))
        out.push_back(listed(match));
    if (out.empty()) throw InputError(place, fmt::format("there is no {}", named.string()), right);
  }
  return out;
}

std::vector<ListedCapture> from_text(const fs::path& file) {
  std::vector<ListedCapture> out;
  std::istringstream lines(read_text(file));
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::string entry = trimmed(line.substr(0, line.find('#')));
    if (entry.empty()) continue;
    for (ListedCapture& one : captures_at(file.parent_path() / entry, {file.string(), number}))
      out.push_back(std::move(one));
  }
  return out;
}

struct TableRow {
  int line = 0;
  std::vector<std::string> cells;
};

/// RFC 4180, with the separator that the head has: comma, semicolon or tab.
class CsvText {
 public:
  explicit CsvText(const fs::path& file) : file_(file), text_(read_text(file)) {
    if (text_.starts_with("\xef\xbb\xbf")) text_.erase(0, 3);
    const std::string head = text_.substr(0, text_.find('\n'));
    for (const char c : {',', ';', '\t'})
      if (std::count(head.begin(), head.end(), c) > std::count(head.begin(), head.end(), between_))
        between_ = c;
  }
  std::vector<TableRow> rows() {
    std::vector<TableRow> out;
    while (at_ < text_.size()) {
      TableRow row{line_, {}};
      do row.cells.push_back(cell());
      while (taken(between_));
      taken('\r');
      if (at_ < text_.size() && !taken('\n'))
        throw InputError({file_.string(), line_}, "text stands behind a closing quote",
                         "a cell wholly in quotes, with \"\" for a quote in it");
      ++line_;
      const bool blank = row.cells.size() == 1 && row.cells[0].empty();
      if (!blank) out.push_back(std::move(row));
    }
    return out;
  }

 private:
  bool taken(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  std::string cell() {
    if (!taken('"')) {
      const size_t end =
          std::min(text_.find_first_of(std::string("\r\n") + between_, at_), text_.size());
      const std::string out = trimmed(text_.substr(at_, end - at_));
      at_ = end;
      return out;
    }
    std::string out;
    const int began = line_;
    for (; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"' && (++at_ >= text_.size() || text_[at_] != '"')) return out;
      line_ += text_[at_] == '\n';
      out += text_[at_];
    }
    throw InputError({file_.string(), began}, "a quote is not closed", "a \" at the cell's end");
  }

  fs::path file_;
  std::string text_;
  char between_ = ',';
  size_t at_ = 0;
  int line_ = 1;
};

std::vector<std::string> values_in(const std::string& cell) {
  std::vector<std::string> out;
  std::istringstream parts(cell);
  for (std::string part; std::getline(parts, part, ';');)
    if (!trimmed(part).empty()) out.push_back(trimmed(part));
  return out;
}

/// "" adds nothing; a flag's cell says yes or no.
void add_options(const std::string& name, OptionKind kind, const std::string& cell,
                 const Place& place, std::vector<std::string>& out) {
  if (kind == OptionKind::valued) {
    for (const std::string& value : values_in(cell)) out.insert(out.end(), {"--" + name, value});
    return;
  }
  if (cell.empty() || cell == "no" || cell == "0") return;
  if (cell != "yes" && cell != "1")
    throw InputError(place, fmt::format("`{}` takes no value, and its cell holds '{}'", name, cell),
                     "yes, no, or nothing");
  out.push_back("--" + name);
}

std::vector<ListedCapture> from_table(const fs::path& file, const KindOfOption& kind_of) {
  const std::vector<TableRow> rows = CsvText(file).rows();
  const std::vector<std::string> head = rows.empty() ? std::vector<std::string>() : rows[0].cells;
  const auto column = [&](const char* name) {
    return static_cast<size_t>(std::find(head.begin(), head.end(), name) - head.begin());
  };
  const size_t capture = column("capture"), label = column("name");
  if (capture == head.size())
    throw InputError({file.string(), 1}, "the table has no column `capture`",
                     "a first line such as: capture,name,set");
  for (const std::string& name : head)
    if (name != "capture" && name != "name" && kind_of(name) == OptionKind::unknown)
      throw InputError(
          {file.string(), 1}, fmt::format("the verb has no option --{}", name),
          "columns `capture`, `name`, and long options of the verb without the dashes");
  std::vector<ListedCapture> out;
  for (size_t r = 1; r < rows.size(); ++r) {
    const Place place{file.string(), rows[r].line};
    const std::vector<std::string>& cells = rows[r].cells;
    if (cells.size() != head.size())
      throw InputError(place,
                       fmt::format("{} cells stand below {} columns", cells.size(), head.size()),
                       "as many as the first line has");
    std::vector<std::string> options;
    for (size_t c = 0; c < head.size(); ++c)
      if (c != capture && c != label)
        add_options(head[c], kind_of(head[c]), cells[c], place, options);
    for (ListedCapture& one : captures_at(file.parent_path() / cells[capture], place)) {
      if (label < head.size() && !cells[label].empty()) one.label = cells[label];
      one.options = options;
      out.push_back(std::move(one));
    }
  }
  return out;
}

}  // namespace

std::vector<ListedCapture> read_capture_list(const std::vector<std::string>& words,
                                             const KindOfOption& kind_of) {
  std::vector<ListedCapture> out;
  for (const std::string& word : words) {
    const fs::path named = fs::absolute(word);
    const bool is_list = fs::is_regular_file(named) && !is_yaml(named);
    for (ListedCapture& one : !is_list                      ? captures_at(named, {word})
                              : named.extension() == ".csv" ? from_table(named, kind_of)
                                                            : from_text(named))
      out.push_back(std::move(one));
  }
  return out;
}

}  // namespace hookeye
