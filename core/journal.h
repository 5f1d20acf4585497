// Records in one file, each kept whole as soon as it is there: what a long work has come to so far.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

namespace hookeye {

/// A file that only grows. A kill at any moment leaves at most half a record at its end, which is
/// dropped when it is opened again. One writer at a time: whoever opens it holds the run's lock.
class Journal {
 public:
  /// `made_for`: what the records hold for (program, capture). Those of a file that says otherwise
  /// are not read, and go when the first one is added. The file itself is made then.
  Journal(std::filesystem::path file, std::string made_for);
  ~Journal();
  Journal(Journal&&) noexcept;

  size_t size() const;  ///< records
  std::string read(size_t record) const;
  /// Behind the others; returns its number. Throws InputError where it cannot be written.
  size_t add(const std::string& record);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hookeye
