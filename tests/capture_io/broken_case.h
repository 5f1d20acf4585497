// One way to break a capture, and the whole message that the user gets.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "capture_io/capture_folder.h"

namespace hookeye::test {

struct BrokenCase {
  const char* name;
  std::function<void(CaptureFixture&)> damage;
  const char* message;
};

/// Breaks the fixture's capture and compares the whole complaint (broken_capture_test.cpp).
class BrokenCapture : public testing::TestWithParam<BrokenCase> {};

inline std::string case_name(const testing::TestParamInfo<BrokenCase>& info) {
  return info.param.name;
}

/// Signature and header chunk of a PNG that claims 60000 x 60000 pixels of 16-bit colour.
inline std::string huge_png() {
  const unsigned char bytes[] = {0x89, 'P', 'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a, 0,    0, 0,    13,
                                 'I',  'H', 'D', 'R', 0,    0,    0xea, 0x60, 0,    0, 0xea, 0x60,
                                 16,   2,   0,   0,   0,    0x5f, 0x20, 0x3e, 0x56, 0, 0,    0,
                                 0,    'I', 'D', 'A', 'T',  0x35, 0xaf, 0x06, 0x1e};
  return {reinterpret_cast<const char*>(bytes), sizeof bytes};
}

inline std::function<void(CaptureFixture&)> swap(const char* from, const char* to) {
  return [=](CaptureFixture& c) { c.replace(from, to); };
}

}  // namespace hookeye::test
