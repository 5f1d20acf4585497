#include "capture_io/file_storage.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "capture_io/left_open.h"
#include "capture_io/yaml_file.h"
#include "core/helper.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using Values = std::map<std::string, StoredValue>;

const char* const kWriteIt = "write it with cv::FileStorage (yml, xml or json)";

std::optional<std::vector<double>> numbers_of(const YamlNode& list) {
  if (list.kind != YamlNode::Kind::sequence || list.items.size() > 1000) return {};
  std::vector<double> out;
  for (const YamlNode& item : list.items) {
    const std::optional<double> number = number_of(item);
    if (!number) return {};
    out.push_back(*number);
  }
  return out;
}

/// {rows, cols, data} or a list.
StoredValue matrix_of(const YamlNode& node) {
  StoredValue value;
  value.wrong = "is not a matrix";
  const YamlNode* data = node.kind == YamlNode::Kind::map ? node.find("data") : &node;
  if (!data) return value;
  std::optional<std::vector<double>> numbers = numbers_of(*data);
  if (!numbers) return value;
  value.kind = StoredValue::Kind::matrix;
  value.rows = static_cast<int>(numbers->size()), value.cols = 1;
  value.numbers = std::move(*numbers);
  if (node.kind != YamlNode::Kind::map) return value;
  const YamlNode* rows = node.find("rows");
  const YamlNode* cols = node.find("cols");
  if (rows && cols)
    value.rows = read_integer(*rows, "rows"), value.cols = read_integer(*cols, "cols");
  return value;
}

StoredValue stored(const YamlNode& node) {
  StoredValue value;
  if (node.kind == YamlNode::Kind::scalar) {
    const std::optional<double> number = number_of(node);
    value.kind = number ? StoredValue::Kind::number : StoredValue::Kind::text;
    value.text = node.text;
    if (number) value.numbers = {*number};
  } else {
    value = matrix_of(node);
  }
  value.line = node.place.line;
  return value;
}

/// Of yaml that OpenCV's reader refuses: without its mark.
bool plain_yaml(const fs::path& file, const std::string& text) {
  const std::string ending = file.extension().string();
  return (ending == ".yml" || ending == ".yaml") && !text.starts_with("%YAML");
}

YamlNode parsed_whole(const std::string& text, const std::string& file, const YamlLimits& limits) {
  try {
    return parse_yaml(text, file, limits);
  } catch (const InputError&) {
    const auto open = left_open(text);
    if (!open) throw;
    throw InputError(
        {file, open->last_line},
        fmt::format("the file ends early: {} of line {} is not closed", open->what, open->line),
        "copy the whole file again");
  }
}

Values read_plain(const std::string& text, const std::string& file) {
  YamlLimits limits;
  limits.holds = "calibration";
  limits.begins = "give the file that the calibration program wrote";
  const YamlNode root = parsed_whole(text, file, limits);
  if (root.kind != YamlNode::Kind::map)
    throw InputError({file}, "this is not an OpenCV file", kWriteIt);
  Values values;
  for (const YamlNode::Entry& entry : root.entries) values[entry.key] = stored(entry.value);
  return values;
}

Values ask_reader(const fs::path& file) {
  HelperRequest wanted;
  wanted.name = "calibration";
  wanted.content = Packer().put(file.string()).take();
  wanted.limits = limits_for(file);
  wanted.place.file = file.string();
  wanted.right = kWriteIt;
  wanted.damaged = "this is not an OpenCV file: its reader breaks off";
  return ask_helper(wanted, unpack_stored_values);
}

}  // namespace

StoredFile::StoredFile(const fs::path& file) : file_(file.string()) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) fail("there is no such file", "the calibration's file");
  if (fs::file_size(file, error) > (size_t{16} << 20))
    fail("the calibration is larger than 16 MiB", "a calibration has a few kilobytes");
  const std::string text = read_text(file);
  values_ = plain_yaml(file, text) ? read_plain(text, file_) : ask_reader(file);
}

StoredFile::Named StoredFile::find(const std::vector<std::string>& names) const {
  for (const std::string& name : names) {
    const auto found = values_.find(name);
    if (found != values_.end()) return {name, &found->second};
  }
  return {};
}

double StoredFile::number(const Named& of) const {
  if (of.value->kind != StoredValue::Kind::number)
    fail(of, fmt::format("`{}` holds no number", of.name), "a finite number is expected");
  if (!std::isfinite(of.value->numbers[0]))
    fail(of, fmt::format("`{}` is not finite", of.name), "a finite number is expected");
  return of.value->numbers[0];
}

const StoredValue& StoredFile::matrix(const Named& of) const {
  const StoredValue& value = *of.value;
  if (value.kind != StoredValue::Kind::matrix)
    fail(of, fmt::format("`{}` {}", of.name, value.wrong.empty() ? "is not a matrix" : value.wrong),
         "write !!opencv-matrix with rows, cols, data");
  for (const double number : value.numbers)
    if (!std::isfinite(number))
      fail(of, fmt::format("`{}` is not finite", of.name), "a finite number is expected");
  if (static_cast<double>(value.rows) * value.cols != static_cast<double>(value.numbers.size()))
    fail(of,
         fmt::format("`{}` has {} numbers for {} x {}", of.name, value.numbers.size(), value.rows,
                     value.cols),
         "rows times cols must be the number of data");
  return value;
}

void StoredFile::fail(const std::string& wrong, const std::string& right, int line) const {
  throw InputError({file_, line}, wrong, right);
}

void pack(Packer& to, const Values& values) {
  to.put<uint64_t>(values.size());
  for (const auto& [name, value] : values)
    to.put(name)
        .put(value.kind)
        .put(value.rows)
        .put(value.cols)
        .put(value.numbers)
        .put(value.text)
        .put(value.wrong);
}

Values unpack_stored_values(Unpacker& from) {
  Values values;
  for (auto n = from.take<uint64_t>(); n > 0; --n) {
    const auto name = from.take<std::string>();
    StoredValue value;
    from.get(value.kind);
    from.get(value.rows);
    from.get(value.cols);
    from.get(value.numbers);
    from.get(value.text);
    from.get(value.wrong);
    const bool known =
        value.kind >= StoredValue::Kind::number && value.kind <= StoredValue::Kind::other;
    if (!known || (value.kind == StoredValue::Kind::number && value.numbers.size() != 1))
      throw WireFault();
    values[name] = std::move(value);
  }
  return values;
}

}  // namespace hookeye
