// Tests of what a build may lack.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "core/helper.h"

/// First line of a test that asks the helper `name`; skips loudly where this build has none.
#define HOOKEYE_NEEDS_HELPER(name, package)                                              \
  if (!std::filesystem::exists(hookeye::helper_folder() / (name)))                       \
  GTEST_SKIP() << "NOT RUN: this build has no helper " << (name) << " (apt-get install " \
               << (package) << ", then configure again)"
#define HOOKEYE_NEEDS_GMSH() HOOKEYE_NEEDS_HELPER("gmsh", "libgmsh-dev")
