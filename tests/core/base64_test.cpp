#include "core/base64.h"

#include <gtest/gtest.h>

namespace hookeye {
namespace {

/// RFC 4648, section 10.
TEST(Base64, TestVectorsOfTheStandard) {
  const std::pair<std::string, std::string> pairs[] = {{"", ""},
                                                       {"f", "Zg=="},
                                                       {"fo", "Zm8="},
                                                       {"foo", "Zm9v"},
                                                       {"foob", "Zm9vYg=="},
                                                       {"fooba", "Zm9vYmE="},
                                                       {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : pairs) {
    EXPECT_EQ(base64(bytes.data(), bytes.size()), text);
    EXPECT_EQ(from_base64(text), bytes);
  }
}

TEST(Base64, AllBytesComeBack) {
  std::string bytes;
  for (int i = 0; i < 1025; ++i) bytes += static_cast<char>(i * 37 % 256);
  EXPECT_EQ(from_base64(base64(bytes.data(), bytes.size())), bytes);
}

TEST(Base64, TextsInARowAndBlanks) {
  EXPECT_EQ(from_base64("Zg==Zm8=Zm9v"), "ffofoo");
  EXPECT_EQ(from_base64("\n  Zm9v\r\n\tYmFy\n"), "foobar");
}

TEST(Base64, WhatIsNoneIsRefused) {
  for (const char* text : {"Zg", "Zg=", "Zm9vY", "Zm9*", "=", "Z===", "Zg=v", "Zm9v\x80"})
    EXPECT_FALSE(from_base64(text).has_value()) << text;
}

}  // namespace
}  // namespace hookeye
