// What does it cost to arrange who works on what? Ten thousand captures of a second each and two
// hundred workers, on a simulated clock and disk, by the protocol that `hookeye batch` and `hookeye
// worker` have (tests/sharing/simulated_farm.h). Some workers die, some are out of sight for two
// minutes, some captures take thirty times as long. Ends with status 1 where anything was lost or
// done twice.
//   bench_farm                                  bench_farm --tasks 100000 --workers 1000 --seconds
//   60
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "tests/sharing/simulated_farm.h"

int main(int argc, char** argv) {
  hookeye::test::Farm farm;
  CLI::App app("A farm of workers on one folder, simulated");
  app.add_option("--tasks", farm.tasks, "Captures")->capture_default_str();
  app.add_option("--workers", farm.workers, "Workers")->capture_default_str();
  app.add_option("--seconds", farm.seconds, "Mean length of a task")->capture_default_str();
  app.add_option("--straggling", farm.straggling, "Share that takes thirty times as long")
      ->capture_default_str();
  app.add_option("--failing", farm.failing, "Share that fails")->capture_default_str();
  app.add_option("--deaths", farm.deaths, "Workers that are killed")->capture_default_str();
  app.add_option("--out-of-sight", farm.out_of_sight, "Workers without a disk for two minutes")
      ->capture_default_str();
  app.add_option("--latency", farm.latency, "Of one operation on the disk [s]")
      ->capture_default_str();
  app.add_option("--seed", farm.seed, "Of all that is random")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const hookeye::test::FarmResult result = hookeye::test::simulate(farm);
  fmt::print("{} tasks of {:g} s, {} workers: {}\n", farm.tasks, farm.seconds, farm.workers,
             result.words());
  return result.lost == 0 && result.twice == 0 && result.left_over == 0 ? 0 : 1;
}
