// Which captures a batch is about: of folders, patterns, lists and tables.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/input_error.h"

namespace hookeye {

struct ListedCapture {
  std::filesystem::path capture;     ///< its yaml, absolute
  std::string label;                 ///< the table's `name`, else after its folder
  std::vector<std::string> options;  ///< of its row
};

/// How the verb takes an option: "set" -> with a value.
enum class OptionKind { unknown, flag, valued };
using KindOfOption = std::function<OptionKind(const std::string& name)>;

/// Each word is a capture (its folder or yaml), a folder below which captures lie, a pattern
/// ("specimens/*/capture.yaml"), a text file with one of these a line (# begins a remark), or a CSV
/// table: column `capture`, perhaps `name`, the others options of the verb. Names in a file are
/// relative to it. A cell holds a value, several with ; between them; of an option without a value
/// yes or no. Throws InputError with the line.
std::vector<ListedCapture> read_capture_list(const std::vector<std::string>& words,
                                             const KindOfOption& kind_of);

}  // namespace hookeye
