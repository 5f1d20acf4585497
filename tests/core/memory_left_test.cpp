// What is left of memory, of files as Linux has them, and claims on it.
#include "core/memory_left.h"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>
#include <thread>

#include "core/text_file.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

namespace fs = std::filesystem;

class MemoryLeftTest : public testing::Test {
 protected:
  void write(const std::string& file, const std::string& text) const {
    fs::create_directories((folder_ / file).parent_path());
    write_text(folder_ / file, text);
  }
  MemoryLeft left() const { return memory_left(folder_.path()); }

  TemporaryFolder folder_;
};

TEST_F(MemoryLeftTest, NothingTold) { EXPECT_TRUE(std::isinf(left().bytes)); }

TEST_F(MemoryLeftTest, AsTheOptionTells) {
  write("proc/meminfo", "MemAvailable:   20000000 kB\n");
  write("proc/self/status", "Name: a\nVmRSS:    1000000 kB\n");
  set_memory_limit(4e9);
  const MemoryLeft told = left();
  const double budget = memory_budget();
  set_memory_limit(0.0);
  EXPECT_EQ(told.bytes, 4e9 - 1.024e9) << "less what the process holds";
  EXPECT_EQ(told.of, "`--memory`");
  EXPECT_EQ(budget, 4e9);
  EXPECT_EQ(left().of, "this machine") << "no limit any more";
}

TEST(BytesIn, Units) {
  EXPECT_EQ(bytes_in("4G"), 4e9);
  EXPECT_EQ(bytes_in("1.5 gb"), 1.5e9);
  EXPECT_EQ(bytes_in("300M"), 3e8);
  EXPECT_EQ(bytes_in("1000000"), 1e6);
  for (const char* wrong : {"", "much", "4X", "-1G", "0", "nan", "inf", "1e999", "4G5"})
    EXPECT_FALSE(bytes_in(wrong).has_value()) << wrong;
}

TEST_F(MemoryLeftTest, OfTheMachine) {
  write("proc/meminfo",
        "MemTotal:       24000000 kB\nMemFree:         1000000 kB\nMemAvailable:   20000000 kB\n");
  EXPECT_EQ(left().bytes, 20000000.0 * 1024.0);
  EXPECT_EQ(left().of, "this machine");
}

TEST_F(MemoryLeftTest, OfGroupsOfVersionTwo) {
  write("proc/meminfo", "MemAvailable:   20000000 kB\n");
  write("proc/self/cgroup", "0::/user/job\n");
  write("sys/fs/cgroup/user/job/memory.max", "max\n");
  write("sys/fs/cgroup/user/job/memory.current", "5000\n");
  EXPECT_EQ(left().of, "this machine") << "max is no limit";
  write("sys/fs/cgroup/user/memory.max", "8000000000\n");
  write("sys/fs/cgroup/user/memory.current", "7000000000\n");
  write("sys/fs/cgroup/user/memory.stat", "anon 4000000000\ninactive_file 2500000000\n");
  EXPECT_EQ(left().bytes, 3.5e9) << "of the group above; files in memory are given up";
  EXPECT_EQ(left().of, "the control group (cgroup)");
}

TEST_F(MemoryLeftTest, OfGroupsOfVersionOne) {
  write("proc/self/cgroup", "9:cpu:/a\n4:hugetlb,memory:/docker/1\n0::/\n");
  write("sys/fs/cgroup/memory/memory.limit_in_bytes", "2000000000\n");
  write("sys/fs/cgroup/memory/memory.usage_in_bytes", "2100000000\n");
  EXPECT_EQ(left().bytes, 0.0) << "seen from the container, its group is the mount itself";
  write("sys/fs/cgroup/memory/memory.stat", "inactive_file 1\ntotal_inactive_file 600000000\n");
  EXPECT_EQ(left().bytes, 5e8);
}

TEST_F(MemoryLeftTest, DamagedFilesTellNothing) {
  write("proc/meminfo", "MemAvailable: much\nMemAvailable");
  write("proc/self/cgroup", "\n0\n0:\n::::\n0::\n");
  EXPECT_TRUE(std::isinf(left().bytes));
}

TEST(MemoryClaim, MoreThanThereIsIsRefused) {
  const double there = memory_left().bytes;
  if (std::isinf(there)) GTEST_SKIP() << "no /proc/meminfo";
  try {
    const MemoryClaim claim(2.0 * there);
    FAIL() << "twice of what there is";
  } catch (const OutOfMemory& error) {
    EXPECT_EQ(error.needed(), 2.0 * there);
    EXPECT_THAT(error.what(), testing::HasSubstr("more are needed, and "));
    EXPECT_THAT(error.what(), testing::HasSubstr(error.left().of + " has "));
  }
}

/// Two that fit alone but not together: the second waits for the first.
TEST(MemoryClaim, WaitsForAnother) {
  const double there = memory_left().bytes;
  if (std::isinf(there)) GTEST_SKIP() << "no /proc/meminfo";
  std::optional<MemoryClaim> first(std::in_place, 0.7 * there);
  std::atomic<bool> has = false;
  std::thread other([&] {
    const MemoryClaim second(0.7 * there);
    has = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_FALSE(has);
  first.reset();
  other.join();
  EXPECT_TRUE(has);
}

TEST(MemoryText, GigabytesAndMegabytes) {
  EXPECT_EQ(memory_text(14.23e9), "14.2 GB");
  EXPECT_EQ(memory_text(310.4e6), "310 MB");
}

}  // namespace
}  // namespace hookeye::test
