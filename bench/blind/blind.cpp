// The blind benchmark: draws recipes, photographs them, lets `hookeye discover` look, scores.
#include <fmt/format.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "bench/blind/draw.h"
#include "bench/blind/score.h"
#include "core/text_file.h"
#include "estimation/effects/catalogue.h"
#include "estimation/model/effect.h"
#include "estimation/synth/synth.h"

namespace hookeye::blind {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string hookeye = "hookeye", out = "blind-out", photographer;
  std::vector<std::string> effects;
  unsigned first = 1;
  int seeds = 3;
  int jobs = 1;
  Drawing drawing;
  bool left_out = false;
};

std::string shell_quoted(const fs::path& path) {
  std::string out = "'";
  for (const char c : path.string()) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// Exit status of a shell command.
int run(const std::string& command) {
  const int status = std::system(command.c_str());
  return status == -1 ? 1 : WEXITSTATUS(status);
}

/// Makes `folder`/capture; exit status of synth. Where it refuses the recipe, because the body
/// leaves the picture, the cameras step back.
int photograph(const Options& options, const std::string& effect, unsigned seed,
               const fs::path& folder) {
  constexpr int kRefused = 2;
  int status = kRefused;
  Drawing drawing = options.drawing;
  for (; status == kRefused && drawing.step_back < 8; ++drawing.step_back) {
    write_text(folder / "recipe.yaml", draw_recipe(effect, seed, drawing));
    status = run(fmt::format(
        "{} synth {} -o {} {} 2> {}", shell_quoted(options.hookeye),
        shell_quoted(folder / "recipe.yaml"), shell_quoted(folder / "capture"),
        options.photographer.empty() ? "" : "--photographer " + shell_quoted(options.photographer),
        shell_quoted(folder / "synth.log")));
  }
  return status;
}

/// Of the hidden effects, which were left out, those that a diagnosis by the whole catalogue names
/// beside what the search in `folder` ended with; nothing where there is no diagnosis.
std::optional<std::vector<std::string>> missed_in(const Options& options, const std::string& hidden,
                                                  const fs::path& folder) {
  const fs::path diagnosis = folder / "diagnose.json";
  if (!fs::exists(diagnosis) &&
      run(fmt::format("{0} diagnose --json {1} > {2}.part 2> {3} && mv {2}.part {2}",
                      shell_quoted(options.hookeye), shell_quoted(folder / "run"),
                      shell_quoted(diagnosis), shell_quoted(folder / "diagnose.log"))) != 0)
    return {};
  return named_beside(nlohmann::json::parse(read_text(diagnosis)), effects_of(hidden));
}

/// One capture in a folder of its own. What is there already is not made again.
Score one(const Options& options, const std::string& effect, unsigned seed) {
  const fs::path folder = fs::path(options.out) / fmt::format("{}-{}", effect, seed);
  const fs::path capture = folder / "capture", found = folder / "discover.json";
  fs::create_directories(folder);
  const auto start = std::chrono::steady_clock::now();
  Score failed;
  failed.hidden = effect;
  failed.seed = seed;
  if (!fs::exists(capture)) {
    const int status = photograph(options, effect, seed, folder);
    if (status != 0) {
      failed.status = fmt::format("synth {}", status);
      return failed;
    }
  }
  if (!fs::exists(found)) {
    std::string without;
    if (options.left_out)
      for (const std::string& name : effects_of(effect)) without += " --without " + name;
    // discover works on the folder alone; the truth beside it is read below, after it has ended
    const int status = run(fmt::format(
        "{0} discover --json {1} -o {2} --threads {6}{5} > {3}.part 2> {4} && mv {3}.part {3}",
        shell_quoted(options.hookeye), shell_quoted(capture), shell_quoted(folder / "run"),
        shell_quoted(found), shell_quoted(folder / "discover.log"), without,
        std::max(1, tbb::info::default_concurrency() / options.jobs)));
    if (status != 0) {
      failed.status = fmt::format("discover {}", status);
      return failed;
    }
  }
  Score done = score(nlohmann::json::parse(read_text(found)),
                     nlohmann::json::parse(read_text(truth_file(capture))));
  done.seed = seed;
  done.left_out = options.left_out;
  if (done.explained_by_another()) done.missed = missed_in(options, done.hidden, folder);
  done.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return done;
}

/// Every effect with every seed, `jobs` at once; the tables in the folder grow with each.
std::vector<Score> all(const Options& options) {
  std::vector<Score> scores;
  std::mutex finished;
  const size_t effects = options.effects.size();
  const size_t count = effects * static_cast<size_t>(options.seeds);
  const auto look = [&](size_t i) {
    const auto seed = options.first + static_cast<unsigned>(i / effects);
    const Score s = one(options, options.effects[i % effects], seed);
    const std::lock_guard lock(finished);
    scores.push_back(s);
    fmt::print("{} {}: {}, named {}, held out {:.2f} -> {:.2f}, floor {:.2f}\n", s.hidden, s.seed,
               s.status, s.first, s.held_before, s.held_after, s.floor);
    std::fflush(stdout);
    write_text(fs::path(options.out) / "results.csv", csv(scores));
    write_text(fs::path(options.out) / "table.md", table(scores));
    write_text(fs::path(options.out) / "confusion.svg", confusion_svg(scores));
  };
  // one queue that every job takes the next from: captures take minutes, and not the same
  std::atomic<size_t> next{0};
  tbb::task_arena(options.jobs).execute([&] {
    tbb::parallel_for(0, options.jobs, [&](int) {
      for (size_t i = next++; i < count; i = next++) look(i);
    });
  });
  return scores;
}

/// What can be hidden: nothing, and each effect of the catalogue but the mesh's; or, with `pairs`,
/// each with the one so many places after it.
std::vector<std::string> drawn_effects(int pairs) {
  std::vector<std::string> names, out;
  for (const Effect* effect : catalogue())
    if (effect->group() != EffectGroup::numerical) names.push_back(effect->name());
  for (size_t i = 0; i < names.size() && pairs > 0; ++i)
    out.push_back(names[i] + "+" + names[(i + static_cast<size_t>(pairs)) % names.size()]);
  if (pairs > 0) return out;
  names.insert(names.begin(), "none");
  return names;
}

int main_of(int argc, char** argv) {
  Options options;
  CLI::App app("Hidden effects drawn by seed: how often is the right one named?");
  app.add_option("--hookeye", options.hookeye, "The program under test");
  app.add_option("-o,--out", options.out, "Results; finished captures there are kept");
  app.add_option("--photographer", options.photographer,
                 "Command that takes the pictures (docs/synth.md); default: our renderer");
  app.add_option("-n,--seeds", options.seeds, "Captures per effect");
  app.add_option("--first-seed", options.first, "Seed of the first of them");
  app.add_option("-j,--jobs", options.jobs,
                 "Captures looked at at once, which share the cores between them")
      ->check(CLI::PositiveNumber);
  app.add_flag("--small", options.drawing.small,
               "Photos of 200 x 260 px and fewer loads: seconds a search, not minutes");
  app.add_option("--size", options.drawing.size,
                 "Of what is hidden, times 1.5 to 3.5 px (rms) or one to two typical changes");
  app.add_flag("--left-out", options.left_out,
               "Leave what is hidden out of the catalogue: no other name may explain it");
  app.add_option("-e,--effects", options.effects,
                 "Names, or several at once as gravity+creep; `none` hides nothing (default: none "
                 "and the catalogue but mesh_resolution, which every truth has: its mesh is finer)")
      ->delimiter(',');
  int pairs = 0;
  app.add_option("--pairs", pairs, "Two at once: each with the one that many places after it")
      ->check(CLI::PositiveNumber)
      ->excludes("--effects");
  CLI11_PARSE(app, argc, argv);
  if (options.effects.empty()) options.effects = drawn_effects(pairs);
  const std::vector<Score> scores = all(options);
  fmt::print("\n{}", summary(scores));
  return 0;
}

}  // namespace
}  // namespace hookeye::blind

int main(int argc, char** argv) {
  try {
    return hookeye::blind::main_of(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
