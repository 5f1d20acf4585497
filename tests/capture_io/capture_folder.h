// A small valid capture in a temporary folder, for tests that read it or break it.
#pragma once

#include <filesystem>
#include <string>

#include "support/temporary_folder.h"

namespace hookeye::test {

/// A capture with every key of format 1 and the files that it names (pictures of 8 x 6 pixels).
class CaptureFixture {
 public:
  CaptureFixture();
  std::filesystem::path folder() const { return folder_.path(); }
  /// The text of capture.yaml; write() stores it.
  std::string yaml;
  /// Replaces the one place where `from` stands; throws if there are none or several.
  void replace(const std::string& from, const std::string& to);
  void write() const;
  void write_file(const std::string& name, const std::string& content) const;
  void write_grey(const std::string& name, int width, int height, float value = 0.5f,
                  int channels = 1) const;
  /// What read_capture() says, with the folder struck out; "" when it accepts the capture.
  std::string complaint() const;
  /// Moves the cameras into cameras.yaml.
  void part_cameras();

 private:
  TemporaryFolder folder_;
};

}  // namespace hookeye::test
