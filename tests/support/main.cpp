// Every test binary's main: GoogleTest's, and --file=NAME_test.cpp, which runs the tests of one
// source file. ctest has an entry a file: a process a test would spend most of its time on
// starting.
#include <gmock/gmock.h>

#include <cstdio>
#include <filesystem>
#include <string>

namespace {

std::string file_of(const testing::TestInfo& test) {
  return std::filesystem::path(test.file()).filename().string();
}

/// Names of the tests in `file`, as a filter; empty: none.
std::string filter_of(const std::string& file) {
  const auto& all = *testing::UnitTest::GetInstance();
  std::string filter;
  for (int i = 0; i < all.total_test_suite_count(); ++i)
    for (int k = 0; k < all.GetTestSuite(i)->total_test_count(); ++k) {
      const testing::TestInfo& test = *all.GetTestSuite(i)->GetTestInfo(k);
      if (file_of(test) == file)
        filter +=
            std::string(filter.empty() ? "" : ":") + test.test_suite_name() + "." + test.name();
    }
  return filter;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  const std::string option = "--file=";
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (!argument.starts_with(option)) continue;
    const std::string file = argument.substr(option.size()), filter = filter_of(file);
    if (filter.empty()) {
      std::fprintf(stderr, "no test of this program stands in %s\n", file.c_str());
      return 1;
    }
    GTEST_FLAG_SET(filter, filter);
  }
  return RUN_ALL_TESTS();
}
