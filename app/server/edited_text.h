// The text of a file that is edited here, and may be edited elsewhere meanwhile.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hookeye {

/// Each change is written at once, whole or not at all, and can be taken back. What another program
/// has written since is never written over: it is taken in first. Not thread-safe.
class EditedText {
 public:
  /// Throws InputError where the file cannot be read.
  explicit EditedText(std::filesystem::path file);
  const std::filesystem::path& file() const { return file_; }
  const std::string& text() const { return text_; }
  /// Fingerprint of the text.
  const std::string& mark() const { return mark_; }
  bool changed_outside() const;
  bool can_undo() const { return !before_.empty(); }
  bool can_redo() const { return !after_.empty(); }

  /// `seen`: mark of the text that the change was made to. Throws InputError where that is not the
  /// newest one, or the file was changed outside, and where it cannot be written.
  void set(const std::string& text, const std::string& seen);
  void undo(const std::string& seen);
  void redo(const std::string& seen);
  /// Takes in what another program wrote; undo() then leads back to what was here.
  void reload();

 private:
  void expect_newest(const std::string& seen) const;
  void write(const std::string& text);
  std::filesystem::path file_;
  std::string text_, mark_;
  std::vector<std::string> before_, after_;
};

}  // namespace hookeye
