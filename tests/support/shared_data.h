// Data that other programs and cameras made; it stays outside the project.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace hookeye::test {

/// $HOOKEYE_DATA, else ../shared/data beside the checkout.
inline std::filesystem::path shared_data() {
  if (const char* set = std::getenv("HOOKEYE_DATA")) return set;
  return std::filesystem::path(HOOKEYE_SOURCE_DIR).parent_path() / "shared" / "data";
}

}  // namespace hookeye::test

/// First line of a test that needs `folder` below the shared data; skips loudly without it.
#define HOOKEYE_NEEDS_DATA(folder)                                         \
  if (!std::filesystem::exists(hookeye::test::shared_data() / (folder)))   \
  GTEST_SKIP() << "NOT RUN: " << (hookeye::test::shared_data() / (folder)) \
               << " is not there (set HOOKEYE_DATA)"
