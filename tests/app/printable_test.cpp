// Text from files that a terminal would obey is shown instead, in every output.
#include "runs/printable.h"

#include <gmock/gmock.h>

#include "app/cli.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

TEST(Printable, ShowsWhatATerminalWouldObey) {
  EXPECT_EQ(printable("\x1b[31mred\x1b[0m"), "\\u001b[31mred\\u001b[0m");
  EXPECT_EQ(printable("a\rb\b\a\x7f"), "a\\u000db\\u0008\\u0007\\u007f");
  EXPECT_EQ(printable(std::string("nul\0", 4)), "nul\\u0000");
  // CSI as one character of UTF-8, and as the byte that it is elsewhere.
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "\\u009b2J");
  EXPECT_EQ(printable("\x9b"
                      "2J"),
            "\\x9b2J");
  EXPECT_EQ(printable("\xe2\x80\xae"
                      "gnp.exe"),
            "\\u202egnp.exe");
}

TEST(Printable, KeepsWhatAPersonReads) {
  for (const std::string text :
       {"a line\n\tand another", "mm², 3.2 µm, χ → 1 ≤ 2", "名前", "😀", ""})
    EXPECT_EQ(printable(text), text);
}

/// Neither overlong spellings of a control nor cut characters pass.
TEST(Printable, BytesThatAreNoUtf8AreShown) {
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b");
  EXPECT_EQ(printable("\xe0\x80\x9b"), "\\xe0\\x80\\x9b");
  EXPECT_EQ(printable("\xf0\x80\x80\x9b"), "\\xf0\\x80\\x80\\x9b");
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
  EXPECT_EQ(printable("cut \xe2\x82"), "cut \\xe2\\x82");
}

TEST(Printable, AJsonDocumentStaysTheSame) {
  const json document = {{"title", "\x1b[2J \x7f \xc2\x9b \xe2\x80\xae end\n"}};
  EXPECT_EQ(json::parse(printable(document.dump())), document);
}

/// No byte of `text` moves a cursor or begins a sequence.
bool harmless(const std::string& text) {
  return text.find('\x1b') == std::string::npos && text.find('\r') == std::string::npos &&
         text.find("\xc2\x9b") == std::string::npos &&
         text.find("\xe2\x80\xae") == std::string::npos;
}

/// A cube whose texts hold escapes: title, region, example, and what is quoted in an error.
class Escapes : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    write_cube("{z: 1}");
    text_ = read(folder_ / "capture.yaml");
  }
  void replace(const std::string& from, const std::string& to) {
    for (size_t at = text_.find(from); at != std::string::npos;
         at = text_.find(from, at + to.size()))
      text_.replace(at, from.size(), to);
    write("capture.yaml", text_);
  }
  void expect_shown(const std::string& arguments, int status, const std::string& shown) {
    const Result result = hookeye(arguments);
    EXPECT_EQ(result.status, status) << arguments << ": " << result.err;
    EXPECT_TRUE(harmless(result.out) && harmless(result.err)) << arguments;
    EXPECT_THAT(result.out + result.err, HasSubstr(shown)) << arguments;
  }
  std::string text_;
};

TEST_F(Escapes, InATitleAreShown) {
  replace("title: cube", "title: \"\\e[31mred \\x9b2J \\u202E \\rover\\nfound: nothing\"");
  expect_shown("check .", 0, "\\u001b[31mred \\u009b2J \\u202e  over found: nothing");
  expect_shown("check . --json", 0, "\\u001b[31mred");
  expect_shown("simulate . -o out", 0, "");
}

TEST_F(Escapes, InNamesAreShown) {
  replace("top", "\"t\\x9bop\"");
  replace("pull:", "\"pu\\x9bll\":");
  expect_shown("check .", 0, "t\\u009bop");
  expect_shown("check . --json", 0, "t\\u009bop");
  expect_shown("simulate . -o out", 0, "pu\\u009bll");
}

TEST_F(Escapes, QuotedInErrorsAreShown) {
  const std::string whole = text_;
  replace("neo-hookean", "\"neo\\x9b\\e[31m\"");
  expect_shown("check .", 2, "neo");
  text_ = whole;
  replace("surface: cube.obj", "surface: \"cu\\x9bbe.obj\"");
  expect_shown("check .", 2, "cu\\u009bbe.obj");
  expect_shown("check . --json", 2, "cu\\u009bbe.obj");
  text_ = whole;
  replace("title: cube", "\"ti\\x9btle\": cube");
  expect_shown("check .", 2, "ti\\u009btle");
  expect_shown("check \"$(printf 'no\\033[31mwhere')\"", 2, "no\\u001b[31mwhere");
  expect_shown("\"$(printf 'che\\033[31mck')\"", 2, "there is no command `che\\u001b[31mck`");
  write("capture.yaml", "hookeye: 1\n\x1b[31m: 2\n\xff\xfe\n");
  expect_shown("check .", 2, "capture.yaml");
  write("broken.obj", "v \x1b[31m 0 0\nf 1 2 3\n");
  expect_shown("mesh broken.obj -o body.vtu", 2, "broken.obj");
  write("recipe.yaml", "hookeye_recipe: 1\ntitle: \"\\e[31m\"\nbody: {shape: \"blo\\x9bck\"}\n");
  expect_shown("synth recipe.yaml -o made", 2, "recipe.yaml");
}

}  // namespace
}  // namespace hookeye::test
