// What all targets share. Bytes become a file, a reader of ours is called on it, and one of two
// things is right: it reads the file, or it throws InputError with a place and what is wrong.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/input_error.h"
#include "support/temporary_folder.h"

namespace hookeye::fuzz {

inline const test::TemporaryFolder& folder() {
  static const test::TemporaryFolder own;
  return own;
}

inline void write(const std::string& name, const std::string& bytes) {
  std::ofstream(folder() / name, std::ios::binary) << bytes;
}

/// `read` as the program would call it.
template <class Read>
void expect_no_more_than_refusal(const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    if (!error.wrong().empty() && !error.place().file.empty()) return;
    std::fprintf(stderr, "a refusal without place or reason: %s\n", error.what());
    std::abort();
  }
}

template <class Read>
int on_file(const std::string& name, const uint8_t* data, size_t size, const Read& read) {
  write(name, {reinterpret_cast<const char*>(data), size});
  expect_no_more_than_refusal([&] { read(folder() / name); });
  return 0;
}

}  // namespace hookeye::fuzz
