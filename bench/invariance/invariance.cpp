// The longer form of tests/invariance: whole searches of captures that hide one effect each, told
// in other frames, units and orders. bench/invariance/run builds and runs it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <regex>
#include <vector>

#include "bench/blind/draw.h"
#include "core/text_file.h"
#include "estimation/synth/synth.h"
#include "tests/invariance/transformed.h"

namespace hookeye::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Options {
  std::string hookeye = "hookeye", out = "invariance-out", threads = "2";
  std::vector<std::string> effects = {"none", "gravity", "anisotropy", "camera_pose"};
  std::vector<std::string> only;
  unsigned seed = 1;
  int turns = 2;
  bool meshed = false, small = true;
};

struct Telling {
  std::string name;
  Frame frame = {};
  Order order = {};
  std::string isa = {}, threads = {};  ///< HOOKEYE_ISA; empty: the best, as many as all searches
};

std::vector<Telling> tellings(const Options& options) {
  std::vector<Telling> all = {{.name = "first"}};
  for (int i = 1; i <= options.turns; ++i)
    all.push_back({.name = fmt::format("turned-{}", i), .frame = turned(options.seed + 100 * i)});
  all.push_back({.name = "moved", .frame = moved({-120, 200, 180})});
  all.push_back({.name = "metres", .frame = in_metres()});
  all.push_back({.name = "micrometres", .frame = in_micrometres()});
  // Effects of history count the examples, whose order stays.
  all.push_back(
      {.name = "reordered", .order = {.nodes = 1, .vertices = 1, .cameras = 2, .regions = 2}});
  all.push_back({.name = "sse2-one-thread", .isa = "sse2", .threads = "1"});
  std::erase_if(all, [&](const Telling& one) {
    return !options.only.empty() && one.name != "first" &&
           std::find(options.only.begin(), options.only.end(), one.name) == options.only.end();
  });
  return all;
}

int run(const std::string& command) {
  const int status = std::system(command.c_str());
  return status == -1 ? 1 : WEXITSTATUS(status);
}

/// What `discover --json` ended with, to compare.
struct Ending {
  std::string verdict, missing = {}, sentence = {};
  double chi_fit = 0.0, chi_validate = 0.0;
};

/// Numbers struck: words that do not depend on the frame.
std::string words(const std::string& sentence) {
  static const std::regex number(R"(-?\b\d+(\.\d+)?(e[-+]?\d+)?\b)");
  return std::regex_replace(sentence, number, "#");
}

Ending search(const Options& options, const Telling& telling, const fs::path& folder) {
  const fs::path found = folder / "discover.json";
  if (!fs::exists(found) &&
      run(fmt::format("HOOKEYE_ISA={4} '{0}' discover --json '{1}/capture' -o '{1}/run' --threads "
                      "{2} > '{1}/part' 2> '{1}/log' && mv '{1}/part' '{3}'",
                      options.hookeye, folder.string(),
                      telling.threads.empty() ? options.threads : telling.threads, found.string(),
                      telling.isa)) != 0)
    return {.verdict = "failed"};
  const json document = json::parse(read_text(found));
  const json& last = document.at("steps").back();
  const auto number = [&](const char* key) {
    return last.at(key).is_null() ? 0.0 : last.at(key).get<double>();
  };
  auto missing = document.at("missing").get<std::vector<std::string>>();
  std::erase(missing, "mesh_resolution");  // every truth has it, where it is not the told mesh
  Ending out{document.at("verdict"), fmt::format("{}", fmt::join(missing, "+")), "",
             number("chi_fit"), number("chi_validate")};
  for (const auto& said : last.value("says", json::array()))
    out.sentence += (out.sentence.empty() ? "" : "; ") + said.get<std::string>();
  return out;
}

std::string row(const std::string& effect, const Telling& telling, const Ending& now,
                const Ending& first) {
  const bool same = now.verdict == first.verdict && now.missing == first.missing &&
                    words(now.sentence) == words(first.sentence);
  return fmt::format("| {} | {} | {} | {} | {} | {:.4f} | {:.4f} | {:+.1e} |\n", effect,
                     telling.name, same ? "same" : "**other**", now.verdict,
                     now.missing.empty() ? "-" : now.missing, now.chi_fit, now.chi_validate,
                     now.chi_fit / first.chi_fit - 1.0);
}

void one(const Options& options, const std::string& effect, std::string& table) {
  const fs::path folder = fs::path(options.out) / effect;
  fs::create_directories(folder);
  const fs::path source = folder / "source";
  if (!fs::exists(source)) {
    blind::Drawing drawing;
    drawing.small = options.small;
    std::string recipe = blind::draw_recipe(effect, options.seed, drawing);
    write_text(folder / "recipe.yaml", recipe);
    auto made = synthesize(parse_recipe(recipe, "recipe.yaml"), source);
    if (!made) throw std::runtime_error(made.error().reason);
    if (!options.meshed) keep_own_mesh(source);
  }
  Ending first;
  for (const Telling& telling : tellings(options)) {
    const fs::path told = folder / telling.name;
    if (!fs::exists(told / "capture"))
      write_transformed(source, told / "capture", telling.frame, telling.order);
    const Ending now = search(options, telling, told);
    if (telling.name == "first") first = now;
    table += row(effect, telling, now, first);
    fmt::print("{}    {}\n", row(effect, telling, now, first), now.sentence);
    std::fflush(stdout);
    write_text(fs::path(options.out) / "table.md", table);
  }
}

int main_of(int argc, char** argv) {
  Options options;
  CLI::App app("Whole searches of one capture told in other frames, units and orders");
  app.add_option("--hookeye", options.hookeye, "The program under test");
  app.add_option("-o,--out", options.out, "Results; finished searches there are kept");
  app.add_option("-e,--effects", options.effects, "What is hidden, one capture each; `none` too")
      ->delimiter(',');
  app.add_option("--seed", options.seed, "Of what is drawn");
  app.add_option("--turns", options.turns, "Random rotations");
  app.add_option("--only", options.only, "Names of tellings (default: all)")->delimiter(',');
  app.add_option("--threads", options.threads, "Of a search");
  app.add_flag("--meshed", options.meshed,
               "Mesh each telling anew (default: the same tetrahedra in all)");
  CLI11_PARSE(app, argc, argv);
  std::string table =
      "| hidden | told | answer | verdict | named | chi | held out | chi off by |\n"
      "|---|---|---|---|---|---|---|---|\n";
  for (const std::string& effect : options.effects) one(options, effect, table);
  fmt::print("\n{}", table);
  return 0;
}

}  // namespace
}  // namespace hookeye::test

int main(int argc, char** argv) {
  try {
    return hookeye::test::main_of(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
