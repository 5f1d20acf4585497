// A run as one self-contained page, small enough to be mailed.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

namespace hookeye {

struct WriteReport {
  const std::atomic<bool>* cancel = nullptr;
  std::function<void(int done, int of)> progress;  ///< parts of the page; may begin anew
};

/// Writes the page whole or not at all. Returns {hookeye, report, bytes, reduction, faults,
/// answer}; `reduction`: what was left out to keep it small, "" if nothing. Throws InputError,
/// Interrupted.
nlohmann::json write_report(const std::filesystem::path& folder, const std::filesystem::path& out,
                            const WriteReport& told = {});

}  // namespace hookeye
