// The only file that touches OpenCV's reader. A program of its own: nested deeply enough, a file
// overruns the reader's stack. Numbers are taken from the raw nodes (rows, cols, data) instead of
// cv::Mat, so that plain maps without OpenCV's type tags read as well.
#include <opencv2/core.hpp>

#include "capture_io/file_storage.h"
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

std::map<std::string, StoredValue> read(const std::filesystem::path& file) {
  const std::string right = "write it with cv::FileStorage (yml, xml or json)";
  std::map<std::string, StoredValue> values;
  try {
    cv::FileStorage storage(read_text(file), cv::FileStorage::READ | cv::FileStorage::MEMORY);
    if (!storage.isOpened()) throw InputError({file.string()}, "this is not an OpenCV file", right);
    for (const cv::FileNode& node : storage.root())
      if (!node.empty() && !node.isNone()) values[node.name()] = stored(node);
  } catch (const cv::Exception&) {
    throw InputError({file.string()}, "this is not an OpenCV file", right);
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
