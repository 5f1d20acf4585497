// A right capture made by synth, and copies of it with one mistake each.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "capture_io/image.h"
#include "estimation/inspection/inspection.h"
#include "support/temporary_folder.h"

namespace hookeye::test {

/// A folder with a capture that may be changed and looked at.
class InspectedCapture {
 public:
  /// A copy of the right capture, which is made once a process: two cameras; rest, pull, side,
  /// twist and press; poke held out.
  InspectedCapture();
  /// The same of another recipe.
  explicit InspectedCapture(const std::string& recipe);

  const std::filesystem::path& folder() const { return folder_.path(); }
  /// Every match of the regular expression in capture.yaml, of which there must be one.
  void change(const std::string& what, const std::string& by);
  /// Every number list after `key: [` by `f`, all over capture.yaml.
  void change_numbers(const std::string& key, const std::function<double(double)>& f);
  /// Every photo as it is stored (codes over full scale), changed and written with `bits`.
  void change_photos(const std::function<Image(const Image&)>& f, int bits = 8);
  std::string text() const;

  Inspection inspect(const InspectionOptions& options = {}) const;

 private:
  TemporaryFolder folder_;
};

/// "question: seen; right" of all warnings, one a line.
std::string said(const Inspection& inspection);

}  // namespace hookeye::test
