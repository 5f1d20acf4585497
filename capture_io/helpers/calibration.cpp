// The only file that touches OpenCV's reader. A program of its own: nested deeply enough, a file
// overruns the reader's stack. Numbers are taken from the raw nodes (rows, cols, data) instead of
// cv::Mat, so that plain maps without OpenCV's type tags read as well.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <opencv2/core.hpp>

#include "capture_io/file_storage.h"
#include "capture_io/left_open.h"
#include "core/helper_main.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

bool is_number(const cv::FileNode& node) { return node.isInt() || node.isReal(); }

/// A matrix {rows, cols, data} or a plain list (a column).
StoredValue matrix_of(const cv::FileNode& node) {
  StoredValue value;
  const cv::FileNode data = node.isMap() ? node["data"] : node;
  if (node.isMap() && data.empty() && !node["rows"].empty()) {
    value.wrong = "has rows but no data: does the file end early?";
    return value;
  }
  if (!data.isSeq() || data.size() > 1000) {
    value.wrong = "is not a matrix";
    return value;
  }
  for (const cv::FileNode& item : data) {
    if (!is_number(item)) {
      value.wrong = "holds no number";
      return value;
    }
    value.numbers.push_back(static_cast<double>(item));
  }
  value.rows = static_cast<int>(value.numbers.size()), value.cols = 1;
  if (node.isMap()) {
    if (!node["rows"].isInt() || !node["cols"].isInt()) {
      value.wrong = "has no rows and cols";
      return value;
    }
    value.rows = static_cast<int>(node["rows"]), value.cols = static_cast<int>(node["cols"]);
  }
  value.kind = StoredValue::Kind::matrix;
  return value;
}

StoredValue stored(const cv::FileNode& node) {
  if (!is_number(node) && !node.isString()) return matrix_of(node);
  StoredValue value;
  value.kind = node.isString() ? StoredValue::Kind::text : StoredValue::Kind::number;
  if (node.isString())
    value.text = static_cast<std::string>(node);
  else
    value.numbers = {static_cast<double>(node)};
  return value;
}

/// The line in "file(12): Missing , between the elements"; 0: none.
int line_in(const std::string& message) {
  const size_t open = message.find('('), close = message.find("): ");
  if (open == std::string::npos || close == std::string::npos || close < open) return 0;
  const std::string number = message.substr(open + 1, close - open - 1);
  const bool digits = !number.empty() && number.size() < 9 &&
                      number.find_first_not_of("0123456789") == std::string::npos;
  return digits ? std::stoi(number) : 0;
}

/// `text`, which OpenCV refuses, at the line where it does or where the text ends early.
InputError refused(const std::filesystem::path& file, const std::string& text, int line) {
  if (const auto open = left_open(text))
    return {{file.string(), open->last_line},
            fmt::format("the file ends early: {} of line {} is not closed", open->what, open->line),
            "copy the whole file again, or write it anew with cv::FileStorage"};
  const bool whole = text.empty() || text.back() == '\n';
  const auto lines = static_cast<int>(std::count(text.begin(), text.end(), '\n')) + !whole;
  if (line == lines && !whole)
    return {{file.string(), line},
            "the file ends early: its last line is not whole",
            "copy the whole file again, or write it anew with cv::FileStorage"};
  return {{file.string(), line},
          "this is not an OpenCV file",
          "write it with cv::FileStorage (yml, xml or json)"};
}

std::map<std::string, StoredValue> read(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  std::map<std::string, StoredValue> values;
  try {
    cv::FileStorage storage(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
    if (!storage.isOpened()) throw refused(file, text, 0);
    for (const cv::FileNode& node : storage.root())
      if (!node.empty() && !node.isNone()) values[node.name()] = stored(node);
  } catch (const cv::Exception& error) {
    throw refused(file, text, line_in(error.err));
  }
  return values;
}

std::string answer(Unpacker& request) {
  Packer out;
  pack(out, read(request.take<std::string>()));
  return out.take();
}

}  // namespace
}  // namespace hookeye

int main() { return hookeye::serve(hookeye::answer); }
