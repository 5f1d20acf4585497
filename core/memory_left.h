// Memory that the program may still take, and claims on it.
#pragma once

#include <filesystem>
#include <new>
#include <optional>
#include <string>

namespace hookeye {

/// What may still be taken, and which limit says so.
struct MemoryLeft {
  double bytes = 0.0;
  std::string of;  ///< "this machine", "the control group (cgroup)", "`ulimit -v`"
};

/// The least of what the machine has available without swapping, of what the process's control
/// groups (versions 1 and 2) allow, of RLIMIT_AS, and of set_memory_limit(). Infinite where nothing
/// tells. `root`: the folder in which proc and sys lie.
MemoryLeft memory_left(const std::filesystem::path& root = "/");

/// At most so many bytes for the whole process, if more than zero (`--memory`): memory_left() heeds
/// it. Set once, before anything is worked out.
void set_memory_limit(double bytes);
/// That limit; where none is set half of what machine and groups leave at the first call.
double memory_budget();
/// "4G", "1.5 GB", "300M" (powers of 1000, as in messages) or a number of bytes. Empty: none of
/// these.
std::optional<double> bytes_in(const std::string& text);

/// "14.2 GB", "310 MB".
std::string memory_text(double bytes);

/// More is needed than there is. what(): "14.2 GB are needed, and this machine has 9.1 GB left".
class OutOfMemory : public std::bad_alloc {
 public:
  OutOfMemory(double needed, MemoryLeft left);
  const char* what() const noexcept override { return what_.c_str(); }
  double needed() const { return needed_; }  ///< [bytes]
  const MemoryLeft& left() const { return left_; }

 private:
  double needed_;
  MemoryLeft left_;
  std::string what_;
};

/// Throws OutOfMemory where `bytes` more are not there. The system promises more than it has and
/// kills who takes it at its word; so one looks before. Costs some reads of files in /proc, and
/// nothing below 64 MB, which is not what a machine lacks. (Under `ulimit -v` less is looked after,
/// too.)
void demand_memory(double bytes);

/// `bytes` that are about to be filled, one page after the other: what others find left is that
/// much less until the claim ends. Any thread. Where only claims of others stand in the way it
/// waits for their end. Throws OutOfMemory.
class MemoryClaim {
 public:
  explicit MemoryClaim(double bytes);
  ~MemoryClaim();
  MemoryClaim(const MemoryClaim&) = delete;
  MemoryClaim& operator=(const MemoryClaim&) = delete;

 private:
  double bytes_;
};

}  // namespace hookeye
