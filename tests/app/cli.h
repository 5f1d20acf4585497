// The program from outside, in a folder of its own: what all tests of it share.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace hookeye::test {

namespace fs = std::filesystem;
using nlohmann::json;
inline std::string read(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// A folder of its own, removed at the end.
class Cli : public testing::Test {
 protected:
  struct Result {
    int status;
    std::string out, err;
  };

  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "hookeye-cli-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  Result hookeye(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.string() + "' && '" HOOKEYE_PROGRAM "' " +
                                arguments + " >out.txt 2>err.txt </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(folder_ / "out.txt"),
            read(folder_ / "err.txt")};
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  /// `capture`, and recipe.yaml beside it, by `synth`: once a process, and copied from then on.
  void photograph(const std::string& recipe) const {
    static const TemporaryFolder kept;
    static std::map<std::string, fs::path> made;
    const auto found = made.find(recipe);
    if (found != made.end()) return fs::copy(found->second, folder_, fs::copy_options::recursive);
    write("recipe.yaml", recipe);
    const Result result = hookeye("synth recipe.yaml -o capture");
    ASSERT_EQ(result.status, 0) << result.err;
    for (const char* said : {"out.txt", "err.txt"}) fs::remove(folder_ / said);
    const fs::path copy = kept / std::to_string(made.size());
    fs::copy(folder_, copy, fs::copy_options::recursive);
    made.emplace(recipe, copy);
  }

  /// A cube of 10 mm on a table; `move` is the prescribed motion of its top.
  void write_cube(const std::string& move, const std::string& law = "neo-hookean") const {
    write("cube.obj", R"(v 0 0 0
v 10 0 0
v 10 10 0
v 0 10 0
v 0 0 10
v 10 0 10
v 10 10 10
v 0 10 10
f 1 3 2
f 1 4 3
f 5 6 7
f 5 7 8
f 1 2 6
f 1 6 5
f 2 3 7
f 2 7 6
f 3 4 8
f 3 8 7
f 4 1 5
f 4 5 8
)");
    write("capture.yaml", R"(hookeye: 1
title: cube
units: {length: mm, force: N}
body:
  surface: cube.obj
  mesh: {edge: 6, order: 1}
model:
  material: {law: )" + law + R"(, mu: 0.05, kappa: 0.5}
  fit: [mu]
regions:
  base: {box: [[-1, -1, -0.1], [11, 11, 0.1]]}
  top: {box: [[-1, -1, 9.9], [11, 11, 10.1]]}
examples:
  pull:
    supports:
      - {region: base, fix: [x, y, z]}
      - {region: top, move: )" +
                              move + R"(}
)");
  }

  fs::path folder_;
};

/// Columns, not bytes: characters beyond ASCII take more of these.
inline size_t columns_of(const std::string& line) {
  return static_cast<size_t>(
      std::count_if(line.begin(), line.end(), [](unsigned char c) { return (c & 0xC0) != 0x80; }));
}

/// The lines of `text` that pass 100 columns.
inline std::vector<std::string> too_long(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (columns_of(line) > 100) out.push_back(line);
  return out;
}

/// Without the ends of lines that the terminal's width asks for.
inline std::string on_one_line(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (const char one = c == '\n' ? ' ' : c; one != ' ' || out.empty() || out.back() != ' ')
      out += one;
  return out;
}

}  // namespace hookeye::test
