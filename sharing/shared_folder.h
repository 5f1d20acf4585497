// A folder that many processes use at once, and a clock of one's own: all that tickets and
// heartbeats ask of a machine. A disk has one; a simulation has another (bench/farm.cpp).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hookeye {

/// Files are named relative to it: "todo/1f.0". No file is locked: locks of network file systems
/// are not to be relied on, renames are.
class SharedFolder {
 public:
  virtual ~SharedFolder() = default;

  /// Files in one of its folders, in any order; none that begins with a dot. Throws
  /// std::filesystem::filesystem_error where there is no such folder.
  virtual std::vector<std::string> names(const std::string& folder) = 0;
  virtual bool exists(const std::string& file) = 0;
  /// Empty: it is not there.
  virtual std::optional<std::string> read(const std::string& file) = 0;
  /// Whole or not at all. Throws InputError where it cannot be.
  virtual void write(const std::string& file, const std::string& text) = 0;
  /// Under its final name from the start, so that a writer that dies leaves nothing under another.
  /// For files that nobody reads before their writer links them. Throws as write().
  virtual void write_openly(const std::string& file, const std::string& text) = 0;
  /// False: `from` is not there (any more). Of those who rename it at once one succeeds. Throws
  /// InputError where it cannot be for another reason.
  virtual bool rename(const std::string& from, const std::string& to) = 0;
  /// One more name for a file. False: there is one of that name. Throws as rename().
  virtual bool link(const std::string& from, const std::string& to) = 0;
  virtual void remove(const std::string& file) = 0;

  /// [s] By a clock that never goes back, of whoever asks.
  virtual double seconds() const = 0;
};

/// On a disk, which may be another machine's. `lasting`: what write_openly() has written outlives a
/// power cut. A search that is begun again needs none of it, and asks for hundreds a minute.
std::shared_ptr<SharedFolder> folder_on_disk(const std::filesystem::path& folder,
                                             bool lasting = true);

}  // namespace hookeye
