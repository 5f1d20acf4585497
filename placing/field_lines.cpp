#include "placing/field_lines.h"

#include <charconv>
#include <cmath>
#include <sstream>

#include "core/text_file.h"

namespace hookeye {

std::vector<FieldLine> field_lines(const std::filesystem::path& file) {
  std::istringstream lines(read_text(file));
  std::vector<FieldLine> out;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // a byte order mark
    line.resize(std::min(line.size(), line.find('#')));
    for (char& c : line)
      if (c == ',' || c == ';' || c == '\t' || c == '\r') c = ' ';
    std::istringstream fields(line);
    FieldLine one{{file.string(), number}, {}};
    for (std::string field; fields >> field;) one.fields.push_back(field);
    if (!one.fields.empty()) out.push_back(std::move(one));
  }
  return out;
}

std::vector<double> numbers_in(const std::vector<std::string>& fields, size_t first, size_t count) {
  if (fields.size() != first + count) return {};
  std::vector<double> out;
  for (size_t i = first; i < fields.size(); ++i) {
    const std::string& field = fields[i];
    const size_t begin = field.find_first_not_of(" \t"), end = field.find_last_not_of(" \t");
    if (begin == std::string::npos) return {};
    const char* const from = field.data() + begin + (field[begin] == '+' ? 1 : 0);
    const char* const to = field.data() + end + 1;
    double value = 0.0;
    const auto [at, fault] = std::from_chars(from, to, value);
    if (fault != std::errc() || at != to || !std::isfinite(value)) return {};
    out.push_back(value);
  }
  return out;
}

}  // namespace hookeye
