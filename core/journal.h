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
  /// One that another process writes, for reading alone; the file may not be there yet. Records of
  /// something else are not seen.
  static Journal of_another(std::filesystem::path file, std::string made_for);
  ~Journal();
  Journal(Journal&&) noexcept;

  size_t size() const;  ///< records
  std::string read(size_t record) const;
  /// Of another's: takes in what was added since. Where the file was begun anew, it is another one:
  /// nothing more is seen of it.
  void look_again();
  /// What was added is on the disk, for other machines too.
  void sync() const;
  /// Behind the others; returns its number. Throws InputError where it cannot be written.
  size_t add(const std::string& record);

 private:
  struct Impl;
  explicit Journal(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace hookeye
