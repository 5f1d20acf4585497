// Where a text of yaml, json or xml that cv::FileStorage wrote breaks off.
#pragma once

#include <optional>
#include <string>

namespace hookeye {

/// What is begun and never ended.
struct LeftOpen {
  std::string what;   ///< "`[`", "`<opencv_storage>`"
  int line = 0;       ///< where it begins
  int last_line = 0;  ///< where the text ends
};

/// The innermost of them; none: the text may be whole. For a text that its reader refuses: brackets
/// in a plain scalar count, too.
std::optional<LeftOpen> left_open(const std::string& text);

}  // namespace hookeye
