// docs/effects.md says of every effect what the catalogue says. After a change of the catalogue:
//   HOOKEYE_WRITE_DOCS=1 build/release/tests/test_estimation --gtest_filter='Manual.*'
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "estimation/effects/catalogue.h"
#include "estimation/effects_scene.h"
#include "estimation/model/declaration.h"

namespace hookeye::test {

namespace {

const char* const kHead = R"(# The effects

What a model may lack, as `hookeye diagnose` tests it. How the residual of each looks: the gallery
([gallery.md](gallery.md)). This page is written from the catalogue and checked against it by the tests.

Parameters are those of a block of 20 x 16 x 40 mm that is pulled, twisted, bent and pressed, in
millimetres and newtons. At its null an effect leaves the model as it is. `null` is that value,
`matters` the change that counts as large, in the same unit.

`hookeye effects` lists the same on a terminal. `hookeye effects NAME` adds the forms that a refit may
go on to, with their parameters. `--capture CAPTURE` lists what can be tested in your capture, in its units.

Names stand in every command, file and test. An effect of your own is a class in Python
([python.md](python.md#an-effect-of-your-own)), or a file in C++ (`estimation/effects/README.md` in the sources).

)";

std::string number(double x) { return std::isfinite(x) ? fmt::format("{:.3g}", x) : "none"; }

/// Words in lines of at most 100 characters.
std::string wrapped(const std::string& text, const std::string& indent = "") {
  std::istringstream words(text);
  std::string out, line = indent, word;
  while (words >> word) {
    if (line.size() + word.size() + 1 > 100) out += line + "\n", line = indent;
    line += (line.size() > indent.size() ? " " : "") + word;
  }
  return out + line + "\n";
}

std::string ways(const std::vector<std::shared_ptr<const Ingredient>>& candidates) {
  if (candidates.size() == 1 && candidates.front()->variant().empty()) return "";
  std::string text =
      fmt::format("Tried in {} way{}: ", candidates.size(), candidates.size() == 1 ? "" : "s");
  constexpr size_t kMost = 60;
  for (size_t i = 0; i < candidates.size() && i < 3; ++i) {
    std::string one = candidates[i]->variant().empty() ? "plain" : candidates[i]->variant();
    if (one.size() > kMost) one.replace(one.rfind(' ', kMost), std::string::npos, " ...");
    text += (i ? "; " : "") + one;
  }
  return text + (candidates.size() > 3 ? "; and so on." : ".");
}

std::string section(const Effect& effect, const Model& model) {
  const auto candidates = effect.candidates(model, nullptr);
  std::string text = fmt::format("### `{}`: {}\n\n", effect.name(), effect.title());
  text += wrapped(effect.manual()) + "\n";
  if (candidates.empty()) return text;
  const Ingredient& first = *candidates.front();
  if (const std::string all = ways(candidates); !all.empty()) text += wrapped(all) + "\n";
  text += wrapped(
      fmt::format("Said as: \"{}\".", effect.sentence(model, first, typical_values(first))));
  text +=
      "\n| parameter | meaning | unit | null | from | to | matters "
      "|\n|---|---|---|---|---|---|---|\n";
  const auto parameters = first.parameters();
  for (size_t i = 0; i < parameters.size() && i < 6; ++i) {
    const Parameter& p = parameters[i];
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} | {} |\n", p.name, p.long_name,
                        p.unit.empty() ? "-" : p.unit, number(p.value), number(p.low),
                        number(p.high), number(p.typical));
  }
  if (parameters.size() > 6) text += fmt::format("\nand {} more.\n", parameters.size() - 6);
  return text + "\n";
}

std::string page() {
  const ModelForm form = base_form(block_scene());
  const Model model = form.realise(form.initial());
  std::string text = kHead;
  std::string group;
  for (const Effect* effect : catalogue()) {
    if (group_name(effect->group()) != group) {
      group = group_name(effect->group());
      text +=
          fmt::format("## {}{}\n\n", static_cast<char>(std::toupper(group[0])), group.substr(1));
    }
    text += section(*effect, model);
  }
  text.pop_back();
  return text;
}

TEST(Manual, SaysWhatTheCatalogueSays) {
  const std::string file = std::string(HOOKEYE_SOURCE_DIR) + "/docs/effects.md";
  const std::string now = page();
  if (std::getenv("HOOKEYE_WRITE_DOCS")) std::ofstream(file) << now;
  std::ostringstream written;
  written << std::ifstream(file).rdbuf();
  EXPECT_EQ(written.str(), now) << "write it anew: see the head of " << __FILE__;
}

}  // namespace

}  // namespace hookeye::test
