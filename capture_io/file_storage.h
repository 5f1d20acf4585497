// Numbers and texts that cv::FileStorage wrote, or plain yaml in its manner (as ROS writes).
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/input_error.h"
#include "core/wire.h"

namespace hookeye {

/// A value at the top of the file.
struct StoredValue {
  enum class Kind { number, matrix, text, other };
  Kind kind = Kind::other;
  int rows = 0, cols = 0;       ///< a plain list is a column
  std::vector<double> numbers;  ///< row by row; not all need be finite
  std::string text;
  std::string wrong;  ///< of Kind::other, behind the value's name: "is not a matrix"
  int line = 0;       ///< 0: its reader does not tell
};

class StoredFile {
 public:
  /// yml, xml or json. OpenCV's reader runs in a helper (helpers/calibration.cpp); yaml without its
  /// mark `%YAML` is read here. Throws InputError.
  explicit StoredFile(const std::filesystem::path& file);

  struct Named {
    std::string name;
    const StoredValue* value = nullptr;
    explicit operator bool() const { return value != nullptr; }
  };
  /// The first of the names that the file has.
  Named find(const std::vector<std::string>& names) const;
  /// A finite number; a matrix or list of them. Throws InputError.
  double number(const Named& of) const;
  const StoredValue& matrix(const Named& of) const;
  const std::map<std::string, StoredValue>& values() const { return values_; }
  [[noreturn]] void fail(const std::string& wrong, const std::string& right, int line = 0) const;
  [[noreturn]] void fail(const Named& at, const std::string& wrong,
                         const std::string& right) const {
    fail(wrong, right, at.value->line);
  }

 private:
  std::string file_;
  std::map<std::string, StoredValue> values_;
};

void pack(Packer& to, const std::map<std::string, StoredValue>& values);
std::map<std::string, StoredValue> unpack_stored_values(Unpacker& from);

}  // namespace hookeye
