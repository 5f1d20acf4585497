// Records in one file, each kept whole as soon as it is there: what a long work has come to so far.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
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

/// The records of a journal that another process adds to, here or on another machine.
class JournalReader {
 public:
  /// There need not be such a file yet.
  JournalReader(std::filesystem::path file, std::string made_for);
  ~JournalReader();
  JournalReader(JournalReader&&) noexcept;

  /// Takes up what has come since the last time. Half a record counts when it is whole.
  void look();
  /// The file holds what was made for something else: none of its records is taken.
  bool strange() const;
  size_t size() const;  ///< records
  /// Empty: the file was begun anew, and has it no more.
  std::optional<std::string> read(size_t record) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hookeye
