// Man pages and completions: all that --help tells stands in them, and shells take them.
#include <gmock/gmock.h>

#include <regex>
#include <set>

#include "app/cli.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class Manual : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    ASSERT_EQ(hookeye("manual -o made").status, 0);
  }

  /// The commands that --help lists.
  std::vector<std::string> verbs() const {
    const std::string help = hookeye("--help").out;
    std::vector<std::string> out;
    std::istringstream lines(help.substr(help.find("Subcommands:")));
    static const std::regex line_of_one("  ([a-z]+) +.*");
    std::smatch match;
    for (std::string line; std::getline(lines, line);)
      if (std::regex_match(line, match, line_of_one)) out.push_back(match[1]);
    return out;
  }

  /// Its long options, as --help has them.
  std::set<std::string> options_of(const std::string& verb) const {
    const std::string help = hookeye(verb + " --help").out;
    std::set<std::string> out;
    static const std::regex option("--[a-z][a-z-]+");
    const std::string told = help.substr(help.find("Options:"));
    for (std::sregex_iterator i(told.begin(), told.end(), option), end; i != end; ++i)
      out.insert(i->str());
    return out;
  }

  /// What a shell prints.
  std::string by(const std::string& shell, const std::string& script) const {
    write("script", script);
    const std::string command =
        "cd '" + folder_.string() + "' && " + shell + " script >said.txt 2>&1 </dev/null";
    return std::system(command.c_str()) == 0 ? read(folder_ / "said.txt")
                                             : "failed: " + read(folder_ / "said.txt");
  }

  std::string completed(const std::string& words) const {
    return by(
        "bash",
        "source made/bash/hookeye\nCOMP_WORDS=(hookeye " + words +
            ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_hookeye\necho \"<${COMPREPLY[*]}>\"\n");
  }
};

TEST_F(Manual, TellsEveryCommandAndOption) {
  const auto all = verbs();
  ASSERT_GT(all.size(), 15u);
  const std::string page = read(folder_ / "made/man1/hookeye.1");
  const std::string bash = read(folder_ / "made/bash/hookeye"),
                    zsh = read(folder_ / "made/zsh/_hookeye"),
                    fish = read(folder_ / "made/fish/hookeye.fish");
  for (const std::string& verb : all) {
    EXPECT_THAT(page, HasSubstr("\\fB" + verb + "\\fR"));
    const std::string own = read(folder_ / ("made/man1/hookeye-" + verb + ".1"));
    for (const std::string& option : options_of(verb)) {
      const std::string escaped = std::regex_replace(option, std::regex("-"), "\\-");
      EXPECT_THAT(own, HasSubstr(escaped)) << verb;
      EXPECT_THAT(bash, HasSubstr(option)) << verb;
      EXPECT_THAT(zsh, HasSubstr(option)) << verb;
      EXPECT_THAT(fish, HasSubstr("__fish_seen_subcommand_from " + verb + "' ")) << verb;
      EXPECT_THAT(fish, HasSubstr(" -l " + option.substr(2))) << verb;
    }
  }
  EXPECT_THAT(page, Not(HasSubstr("manual"))) << "a hidden command is told";
}

TEST_F(Manual, PagesAreGoodTroff) {
  if (std::system("command -v groff >/dev/null") != 0)
    GTEST_SKIP() << "NOT RUN: groff is not there";
  for (const auto& one : fs::directory_iterator(folder_ / "made/man1"))
    EXPECT_EQ(by("sh", "groff -man -Tutf8 -ww -z '" + one.path().string() + "'"), "") << one.path();
}

TEST_F(Manual, BashCompletes) {
  EXPECT_EQ(completed("expla"), "<explain>\n");
  EXPECT_EQ(completed("fit --mat"), "<--material>\n");
  EXPECT_EQ(completed("fit --material ''"), "<additive>\n");
  EXPECT_EQ(completed("--threads 2 fit --mat"), "<--material>\n");
  EXPECT_EQ(completed("add run gravi"), "<gravity>\n");
  write("my capture.yaml", "");
  EXPECT_EQ(completed("check my"), "<my capture.yaml>\n");
  EXPECT_EQ(completed("nothing ''").substr(0, 1), "<");
}

}  // namespace
}  // namespace hookeye::test
