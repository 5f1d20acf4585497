#include "core/memory_left.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <cctype>
#include <cmath>
#include <condition_variable>
#include <fstream>
#include <limits>
#include <map>
#include <mutex>
#include <optional>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace hookeye {
namespace {

namespace fs = std::filesystem;

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
/// Less is not looked after.
constexpr double kSmall = 64e6;
/// Kept back for all that is not foreseen: stacks, pictures, results.
constexpr double kReserve = 32e6;
/// Under `ulimit -v` what is asked for counts, not what is filled. OpenBLAS asks for 134 MB at its
/// first product, and without them it asks again and again for ever.
constexpr double kLimitedReserve = 180e6;

/// The number of a file that has just one; "max" and what is not there: none.
std::optional<double> number_in(const fs::path& file) {
  std::ifstream in(file);
  double value = 0.0;
  if (in >> value) return value;
  return {};
}

/// The number behind a word at the beginning of a line: "MemAvailable:  123 kB".
std::optional<double> number_behind(const fs::path& file, const std::string& word) {
  std::ifstream in(file);
  std::string line;
  while (std::getline(in, line)) {
    if (!line.starts_with(word + " ") && !line.starts_with(word + "\t")) continue;
    try {
      return std::stod(line.substr(word.size()));
    } catch (const std::exception&) {
      return {};
    }
  }
  return {};
}

double available_to_machine(const fs::path& root) {
  const auto kB = number_behind(root / "proc/meminfo", "MemAvailable:");
  return kB ? 1024.0 * *kB : kUnlimited;
}

/// Names of the files of a version of control groups.
struct Files {
  const char *limit, *usage, *cache;  ///< cache: in memory.stat, given up when memory is short
};
constexpr Files kFirst = {"memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"};
constexpr Files kSecond = {"memory.max", "memory.current", "inactive_file"};

/// The least that the group, or one that it is part of, has left.
double left_to_groups(const fs::path& mount, fs::path group, const Files& files) {
  double least = kUnlimited;
  for (group = group.relative_path();; group = group.parent_path()) {
    const fs::path folder = mount / group;
    const auto limit = number_in(folder / files.limit), usage = number_in(folder / files.usage);
    if (limit && usage) {
      const double cache = number_behind(folder / "memory.stat", files.cache).value_or(0.0);
      least = std::min(least, *limit - std::max(0.0, *usage - cache));
    }
    if (group.empty()) return least;
  }
}

/// Lines of proc/self/cgroup are NUMBER:CONTROLLERS:GROUP; version 2 has the number 0 and none of
/// the controllers. In a container the group's own folder may be the mount itself.
double allowed_by_groups(const fs::path& root) {
  std::ifstream in(root / "proc/self/cgroup");
  std::string line;
  double least = kUnlimited;
  while (std::getline(in, line)) {
    const size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const fs::path group = line.substr(second + 1), mount = root / "sys/fs/cgroup";
    if (controllers == ",,")
      least = std::min(least, left_to_groups(mount, group, kSecond));
    else if (controllers.find(",memory,") != std::string::npos)
      least = std::min(least, left_to_groups(mount / "memory", group, kFirst));
  }
  return least;
}

/// Infinite where none is set.
double ulimit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnlimited;
  return static_cast<double>(limit.rlim_cur);
}

double allowed_by_ulimit(const fs::path& root) {
  const double limit = ulimit();
  if (limit == kUnlimited) return limit;
  return limit - 1024.0 * number_behind(root / "proc/self/status", "VmSize:").value_or(0.0);
}

double told_limit = kUnlimited;  ///< `--memory`

/// What is filled counts, and what was given back to the C library does not.
double allowed_by_option(const fs::path& root) {
  if (told_limit == kUnlimited) return told_limit;
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  return told_limit - 1024.0 * number_behind(root / "proc/self/status", "VmRSS:").value_or(0.0);
}

std::mutex claims_mutex;
std::condition_variable claim_ended;
double claimed = 0.0;  ///< by claims that are under way
int claims = 0;

/// Of it, what may be given away.
MemoryLeft without_reserve(MemoryLeft left) {
  left.bytes = std::max(0.0, left.bytes - (ulimit() == kUnlimited ? kReserve : kLimitedReserve));
  return left;
}

}  // namespace

MemoryLeft memory_left(const fs::path& root) {
  MemoryLeft least{available_to_machine(root), "this machine"};
  const auto also = [&](double bytes, const char* of) {
    if (bytes < least.bytes) least = {bytes, of};
  };
  also(allowed_by_groups(root), "the control group (cgroup)");
  also(allowed_by_ulimit(root), "`ulimit -v`");
  also(allowed_by_option(root), "`--memory`");
  least.bytes = std::max(0.0, least.bytes);
  return least;
}

void set_memory_limit(double bytes) { told_limit = bytes > 0.0 ? bytes : kUnlimited; }

double memory_budget() {
  static const double kHalf = 0.5 * memory_left().bytes;
  return told_limit == kUnlimited ? kHalf : told_limit;
}

std::optional<double> bytes_in(const std::string& text) {
  size_t end = 0;
  double value = 0.0;
  try {
    value = std::stod(text, &end);
  } catch (const std::exception&) {
    return {};
  }
  std::string unit;
  for (const char c : text.substr(end))
    if (c != ' ') unit += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  static const std::map<std::string, double> kUnits = {
      {"", 1.0},   {"B", 1.0}, {"K", 1e3},  {"KB", 1e3}, {"M", 1e6},
      {"MB", 1e6}, {"G", 1e9}, {"GB", 1e9}, {"T", 1e12}, {"TB", 1e12}};
  const auto found = kUnits.find(unit);
  if (found == kUnits.end() || !std::isfinite(value) || value <= 0.0) return {};
  return value * found->second;
}

std::string memory_text(double bytes) {
  return bytes >= 1e9 ? fmt::format("{:.3g} GB", bytes / 1e9)
                      : fmt::format("{:.0f} MB", bytes / 1e6);
}

OutOfMemory::OutOfMemory(double needed, MemoryLeft left)
    : needed_(needed),
      left_(std::move(left)),
      what_(fmt::format("{} more are needed, and {} has {} left", memory_text(needed), left_.of,
                        memory_text(left_.bytes))) {}

void demand_memory(double bytes) { const MemoryClaim claim(bytes); }

MemoryClaim::MemoryClaim(double bytes)
    : bytes_(bytes < kSmall && ulimit() == kUnlimited ? 0.0 : bytes) {
  if (bytes_ == 0.0) return;
  std::unique_lock lock(claims_mutex);
  for (;;) {
    MemoryLeft left = without_reserve(memory_left());
    if (bytes_ <= left.bytes - claimed) break;
    if (claims == 0) throw OutOfMemory(bytes_, std::move(left));
    claim_ended.wait(lock);
  }
  claimed += bytes_;
  ++claims;
}

MemoryClaim::~MemoryClaim() {
  if (bytes_ == 0.0) return;
  const std::lock_guard lock(claims_mutex);
  claimed = --claims == 0 ? 0.0 : claimed - bytes_;
  claim_ended.notify_all();
}

}  // namespace hookeye
